// SPDX-License-Identifier: MIT
// Shapes, areas and charts of the built-in surfaces.
#include <genrender/scene/primitives.hpp>

#include <genrender/scene/bounds.hpp>
#include <genrender/scene/uv_overlap.hpp>

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <string>
#include <utility>

namespace {

using namespace genrender;

std::vector<std::pair<std::string, mesh>> all_primitives() {
    return {{"plane", make_plane({2, 3}, 4)},       {"disk", make_disk(1.5f, 24)},
            {"box", make_box({1, 2, 3})},           {"sphere", make_sphere(1.5f, 24)},
            {"capsule", make_capsule(0.5f, 2, 24)}, {"cylinder", make_cylinder(0.5f, 2, 24)}};
}

double area(mesh const& surface) {
    double sum = 0;
    for (auto const& t : surface.triangles) {
        auto const& p = surface.positions;
        sum += static_cast<double>(glm::length(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]))) / 2;
    }
    return sum;
}

} // namespace

TEST_SUITE("scene/primitives") {
    TEST_CASE("no two places of a primitive share a texel and every UV lies on the texture") {
        for (auto const& primitive : all_primitives()) {
            CAPTURE(primitive.first);
            auto const& surface = primitive.second;
            CHECK_NOTHROW(validate(surface));
            auto const overlap = count_uv_overlap(surface, 256);
            CHECK(overlap.overlapping == 0);
            CHECK(overlap.covered > 256 * 256 / 2);
            for (auto const& uv : surface.uvs) {
                REQUIRE(uv.x >= 0);
                REQUIRE(uv.x <= 1);
                REQUIRE(uv.y >= 0);
                REQUIRE(uv.y <= 1);
            }
        }
    }

    TEST_CASE("normals have unit length and agree with the winding") {
        for (auto const& primitive : all_primitives()) {
            CAPTURE(primitive.first);
            auto const& surface = primitive.second;
            REQUIRE(surface.normals.size() == surface.positions.size());
            for (auto const& t : surface.triangles) {
                auto const& p = surface.positions;
                auto const facet = glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]);
                REQUIRE(glm::length(facet) > 0);
                for (int i = 0; i < 3; ++i) {
                    REQUIRE(glm::length(surface.normals[t[i]]) == doctest::Approx(1).epsilon(1e-5));
                }
                // Counter-clockwise from outside; all these shapes are convex.
                auto const mean = surface.normals[t.x] + surface.normals[t.y] + surface.normals[t.z];
                REQUIRE(glm::dot(facet, mean) > 0);
            }
        }
    }

    TEST_CASE("a plane has u along +x and v along +z") {
        auto const plane = make_plane({4, 6});
        REQUIRE(plane.positions.size() == 4);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(plane.positions[i].x == doctest::Approx((plane.uvs[i].x - 0.5f) * 4));
            CHECK(plane.positions[i].z == doctest::Approx((plane.uvs[i].y - 0.5f) * 6));
            CHECK(plane.positions[i].y == 0);
        }
        CHECK(area(make_plane({4, 6}, 5)) == doctest::Approx(24));
    }

    TEST_CASE("a disk has the plane's UVs and the area of a regular polygon") {
        auto const disk = make_disk(2, 12);
        for (std::size_t i = 0; i < disk.positions.size(); ++i) {
            CHECK(disk.positions[i].x == doctest::Approx((disk.uvs[i].x - 0.5f) * 4).epsilon(1e-5));
            CHECK(disk.positions[i].z == doctest::Approx((disk.uvs[i].y - 0.5f) * 4).epsilon(1e-5));
        }
        CHECK(area(disk) == doctest::Approx(12)); // 12 triangles of 2 * 2 * sin(30 degrees) / 2
    }

    TEST_CASE("a box has six faces of four corners and each looks outwards unmirrored") {
        auto const box = make_box({1, 2, 3});
        CHECK(box.positions.size() == 24);
        CHECK(box.triangles.size() == 12);
        CHECK(area(box) == doctest::Approx(2 * (2 + 3 + 6)));
        auto const size = bounds_of(box.positions);
        CHECK(size.upper == glm::vec3(0.5f, 1, 1.5f));
        CHECK(size.lower == -size.upper);
        for (std::size_t face = 0; face < 6; ++face) {
            auto const* const p = &box.positions[4 * face];
            auto const normal = box.normals[4 * face];
            CHECK(glm::dot(normal, p[0]) > 0);
            // Corners are (u, v) = 00, 10, 01, 11; u to the right and v downwards as seen from outside.
            CHECK(glm::dot(glm::cross(p[2] - p[0], p[1] - p[0]), normal) > 0);
        }
        CHECK_THROWS_WITH_AS(make_box({1, 0, 1}), "make_box: size.y is 0.000000, expected a finite length above 0",
                             value_error);
    }

    TEST_CASE("a sphere's UVs are longitude and angle from the pole") {
        auto const sphere = make_sphere(2, 32);
        for (auto const& p : sphere.positions) {
            CHECK(glm::length(p) == doctest::Approx(2));
        }
        for (auto const& t : sphere.triangles) {
            for (int i = 0; i < 3; ++i) {
                auto const& p = sphere.positions[t[i]];
                auto const& uv = sphere.uvs[t[i]];
                CHECK(std::acos(std::clamp(p.y / 2, -1.0f, 1.0f)) ==
                      doctest::Approx(uv.y * std::numbers::pi_v<float>).epsilon(1e-3));
                if (std::hypot(p.x, p.z) > 0) {
                    auto const turn = 2 * std::numbers::pi_v<float> * uv.x;
                    CHECK(p.x == doctest::Approx(std::hypot(p.x, p.z) * std::sin(turn)).epsilon(1e-4));
                    CHECK(p.z == doctest::Approx(std::hypot(p.x, p.z) * std::cos(turn)).epsilon(1e-4));
                }
            }
        }
        CHECK(area(make_sphere(1, 128)) == doctest::Approx(4 * std::numbers::pi).epsilon(1e-3));
    }

    TEST_CASE("a capsule and a cylinder have their extents and areas") {
        auto const capsule = make_capsule(0.5f, 2, 128);
        CHECK(bounds_of(capsule.positions).upper.y == doctest::Approx(1.5));
        CHECK(area(capsule) == doctest::Approx(std::numbers::pi * (2 * 0.5 * 2 + 4 * 0.25)).epsilon(2e-3));
        auto const cylinder = make_cylinder(0.5f, 2, 128);
        CHECK(bounds_of(cylinder.positions).upper.y == doctest::Approx(1));
        CHECK(area(cylinder) == doctest::Approx(std::numbers::pi * (2 * 0.5 * 2 + 2 * 0.25)).epsilon(2e-3));
    }

    TEST_CASE("v of a surface of revolution is the way along its profile") {
        auto const funnel = revolve(std::vector<glm::vec2>{{3, 4}, {0.5f, 4}, {0.5f, 0}}, 8);
        for (std::size_t i = 0; i < funnel.positions.size(); ++i) {
            auto const radius = std::hypot(funnel.positions[i].x, funnel.positions[i].z);
            auto const way = radius > 1 ? 0.0f : funnel.positions[i].y > 1 ? 2.5f : 6.5f;
            CHECK(funnel.uvs[i].y == doctest::Approx(way / 6.5f));
        }
        CHECK(count_uv_overlap(funnel, 64).covered == 64 * 64);
        CHECK(count_uv_overlap(funnel, 64).overlapping == 0);
    }

    TEST_CASE("the seam of a surface of revolution has no gap") {
        auto const sphere = make_sphere(1, 12);
        for (std::size_t ring = 0; ring <= 6; ++ring) {
            CHECK(sphere.positions[ring * 13] == sphere.positions[ring * 13 + 12]);
        }
    }

    TEST_CASE("impossible primitives are refused by name") {
        CHECK_THROWS_WITH_AS(make_plane({-1, 1}), "make_plane: size.x is -1.000000, expected a finite length above 0",
                             value_error);
        CHECK_THROWS_WITH_AS(make_plane({1, 1}, 0), "make_plane: segments is 0, expected at least 1", value_error);
        CHECK_THROWS_WITH_AS(make_disk(1, 2), "make_disk: segments is 2, expected at least 3", value_error);
        CHECK_THROWS_WITH_AS(make_sphere(0), "make_sphere: radius is 0.000000, expected a finite length above 0",
                             value_error);
        CHECK_THROWS_WITH_AS(make_sphere(1, 3), "make_sphere: segments is 3, expected at least 4", value_error);
        CHECK_THROWS_WITH_AS(make_capsule(1, 0), "make_capsule: length is 0.000000, expected a finite length above 0",
                             value_error);
        CHECK_THROWS_WITH_AS(make_cylinder(1, 1, 2), "revolve: segments is 2, expected at least 3", value_error);
        CHECK_THROWS_WITH_AS(revolve(std::vector<glm::vec2>{{1, 1}}, 8),
                             "revolve: profile is 1, expected at least two points", value_error);
        CHECK_THROWS_WITH_AS(revolve(std::vector<glm::vec2>{{1, 1}, {-1, 0}}, 8),
                             "revolve: profile distance is -1.000000, expected at least 0", value_error);
        CHECK_THROWS_WITH_AS(revolve(std::vector<glm::vec2>{{1, 1}, {1, 1}}, 8),
                             "revolve: profile step is 0.000000, expected above 0", value_error);
    }
}
