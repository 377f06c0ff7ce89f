// SPDX-License-Identifier: MIT
// One rasterised frame against closed forms and against an independent ray caster.
#include <genrender/scene/frame_rasterizer.hpp>

#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/scene/primitives.hpp>

#include <doctest/doctest.h>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace {

using namespace genrender;

/// One frame that owns its maps, full of rubbish at first.
struct frame_maps {
    explicit frame_maps(grid_extents grid)
        : uv({grid.height, grid.width, 2}), object({grid.height, grid.width}), coverage({grid.height, grid.width}),
          depth({grid.height, grid.width}) {
        for (std::uint32_t row = 0; row < grid.height; ++row) {
            for (std::uint32_t column = 0; column < grid.width; ++column) {
                uv(row, column, 0) = uv(row, column, 1) = depth(row, column) = -7;
                object(row, column) = 99;
                coverage(row, column) = 1;
            }
        }
    }
    frame_guidance_view view() { return {uv.view(), object.view(), coverage.view(), depth.view()}; }
    std::size_t covered() const {
        std::size_t count = 0;
        for (std::size_t row = 0; row < coverage.extent(0); ++row) {
            for (std::size_t column = 0; column < coverage.extent(1); ++column) {
                count += coverage(row, column);
            }
        }
        return count;
    }

    stack<float, 3> uv;
    stack<std::uint32_t, 2> object;
    stack<std::uint8_t, 2> coverage;
    stack<float, 2> depth;
};

frame_maps drawn(posed_scene const& scene, grid_extents grid) {
    frame_maps maps(grid);
    rasterize_frame(maps.view(), scene);
    return maps;
}

posed_object still(std::uint32_t number, mesh surface, glm::mat4 const& to_world = glm::mat4(1)) {
    return pose({number}, std::make_shared<mesh const>(std::move(surface)), to_world);
}

/// A triangle with UVs 00, 10, 01.
mesh triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) { return {{a, b, c}, {}, {{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}}; }

/// A square across the view at z = -distance, wider than it.
mesh wall(float distance) {
    auto surface = make_plane({20, 20});
    for (auto& p : surface.positions) {
        p = {p.x, -p.z, -distance};
    }
    return surface;
}

/// The ray through a pixel's centre in world space; its parameter is the depth.
struct ray {
    glm::dvec3 origin, direction;
};

ray ray_through(camera const& eye, grid_extents grid, pixel p) {
    auto const half = std::tan(static_cast<double>(eye.vertical_fov) / 2);
    auto const height = static_cast<double>(grid.height), width = static_cast<double>(grid.width);
    auto const x = ((p.column + 0.5) - width / 2) / (height / 2) * half;
    auto const y = (height / 2 - (p.row + 0.5)) / (height / 2) * half;
    auto const to_world = glm::inverse(glm::dmat4(eye.view));
    return {glm::dvec3(to_world * glm::dvec4(0, 0, 0, 1)), glm::dvec3(to_world * glm::dvec4(x, y, -1, 0))};
}

/// Where a ray meets a triangle: depth and the weights of the second and third corner.
struct hit {
    double depth, b, c;
    double edge_distance() const { return std::min({b, c, 1 - b - c}); }
};

/// Moeller & Trumbore, 'Fast, Minimum Storage Ray/Triangle Intersection', 1997; also misses, with weights outside [0,
/// 1].
std::optional<hit> meet(ray const& r, glm::dvec3 p0, glm::dvec3 p1, glm::dvec3 p2) {
    auto const e1 = p1 - p0, e2 = p2 - p0;
    auto const p = glm::cross(r.direction, e2);
    auto const determinant = glm::dot(e1, p);
    if (determinant == 0) {
        return std::nullopt;
    }
    auto const t = r.origin - p0;
    auto const q = glm::cross(t, e1);
    return hit{glm::dot(e2, q) / determinant, glm::dot(t, p) / determinant, glm::dot(r.direction, q) / determinant};
}

double around(double difference) { return std::abs(difference - std::round(difference)); }

} // namespace

TEST_SUITE("scene/frame_rasterizer") {
    TEST_CASE("a wall across the view is equally deep everywhere and its UVs are linear") {
        posed_scene const scene{{}, {still(3, wall(4))}};
        auto const maps = drawn(scene, {12, 16});
        auto const half = std::tan(static_cast<double>(scene.camera.vertical_fov) / 2);
        for (std::uint32_t row = 0; row < 12; ++row) {
            for (std::uint32_t column = 0; column < 16; ++column) {
                REQUIRE(maps.coverage(row, column) == 1);
                REQUIRE(maps.object(row, column) == 3);
                REQUIRE(maps.depth(row, column) == doctest::Approx(4));
                auto const x = 4 * half * (column + 0.5 - 8) / 6;
                auto const y = 4 * half * (6 - (row + 0.5)) / 6;
                REQUIRE(maps.uv(row, column, 0) == doctest::Approx(x / 20 + 0.5));
                REQUIRE(maps.uv(row, column, 1) == doctest::Approx(0.5 - y / 20));
            }
        }
    }

    TEST_CASE("a tilted plane in perspective has the UVs of the ray through each pixel") {
        auto const to_world =
            glm::rotate(glm::translate(glm::mat4(1), {0.3f, -0.5f, 0}), 0.4f, glm::normalize(glm::vec3(1, 0.2f, 0.5f)));
        posed_scene const scene{look_at({1, 2.5f, 3}, {0, 0, 0}, 0.9f), {still(0, make_plane({4, 6}), to_world)}};
        grid_extents const grid{48, 64};
        auto const maps = drawn(scene, grid);
        auto const& p = scene.objects[0].positions;
        auto const corner = glm::dvec3(p[0]), along_u = glm::dvec3(p[1]) - corner, along_v = glm::dvec3(p[2]) - corner;
        std::size_t covered = 0, missed = 0;
        for (std::uint32_t row = 0; row < grid.height; ++row) {
            for (std::uint32_t column = 0; column < grid.width; ++column) {
                auto const r = ray_through(scene.camera, grid, {row, column});
                auto const normal = glm::cross(along_u, along_v);
                auto const depth = glm::dot(corner - r.origin, normal) / glm::dot(r.direction, normal);
                auto const place = r.origin + depth * r.direction - corner;
                auto const u = glm::dot(place, along_u) / glm::dot(along_u, along_u);
                auto const v = glm::dot(place, along_v) / glm::dot(along_v, along_v);
                auto const margin = depth > 0 ? std::min({u, v, 1 - u, 1 - v}) : -1.0;
                if (margin > 1e-6) {
                    ++covered;
                    REQUIRE(maps.coverage(row, column) == 1);
                    REQUIRE(std::abs(static_cast<double>(maps.uv(row, column, 0)) - u) < 1e-5);
                    REQUIRE(std::abs(static_cast<double>(maps.uv(row, column, 1)) - v) < 1e-5);
                    REQUIRE(maps.depth(row, column) == doctest::Approx(depth).epsilon(1e-5));
                } else if (margin < -1e-6) {
                    ++missed;
                    REQUIRE(maps.coverage(row, column) == 0);
                }
            }
        }
        CHECK(covered > grid.size() / 3);
        CHECK(missed > grid.size() / 10);
    }

    TEST_CASE("a fine sphere has the longitude and the polar angle of the ray through each pixel") {
        posed_scene const scene{look_at({0.5f, 0.8f, 2.6f}, {0, 0, 0}, 0.9f), {still(0, make_sphere(1, 512))}};
        grid_extents const grid{64, 64};
        auto const maps = drawn(scene, grid);
        std::size_t compared = 0;
        for (std::uint32_t row = 0; row < grid.height; ++row) {
            for (std::uint32_t column = 0; column < grid.width; ++column) {
                auto const r = ray_through(scene.camera, grid, {row, column});
                auto const a = glm::dot(r.direction, r.direction), b = glm::dot(r.origin, r.direction);
                auto const discriminant = b * b - a * (glm::dot(r.origin, r.origin) - 1);
                if (discriminant < -1e-3) {
                    REQUIRE(maps.coverage(row, column) == 0);
                    continue;
                }
                if (discriminant < 0.1) {
                    continue; // at the silhouette a facet stands in for too much of the sphere
                }
                REQUIRE(maps.coverage(row, column) == 1);
                auto const depth = (-b - std::sqrt(discriminant)) / a;
                auto const p = r.origin + depth * r.direction;
                auto const v = std::acos(p.y) / std::numbers::pi;
                if (v < 0.15 || v > 0.85) {
                    continue; // near a pole, facets are wedges
                }
                auto const u = std::atan2(p.x, p.z) / (2 * std::numbers::pi);
                ++compared;
                REQUIRE(around(static_cast<double>(maps.uv(row, column, 0)) - u) < 1e-4);
                REQUIRE(std::abs(static_cast<double>(maps.uv(row, column, 1)) - v) < 1e-4);
                REQUIRE(maps.depth(row, column) == doctest::Approx(depth).epsilon(1e-4));
            }
        }
        CHECK(compared > grid.size() / 4);
    }

    TEST_CASE("triangle soups around the eye equal an independent ray caster") {
        grid_extents const grid{36, 44};
        std::size_t compared = 0, from_cut_triangles = 0;
        for (std::uint32_t seed = 0; seed < 6; ++seed) {
            posed_scene scene{look_at({0.2f, 0.1f, 0.3f}, {1, 0.5f, -2}, 1.3f), {}};
            scene.camera.near_distance = 0.4f;
            for (std::uint32_t i = 0; i < 40; ++i) {
                std::array<glm::vec3, 3> corners;
                for (std::uint32_t k = 0; k < 9; ++k) {
                    auto const value = uniform_value(seed, random_stream::test, {i, k, 0});
                    corners[k / 3][static_cast<int>(k % 3)] = static_cast<float>(8 * value - 4);
                }
                // Numbers in falling order, so that drawing order and object order differ.
                scene.objects.push_back(still(100 - i, triangle(corners[0], corners[1], corners[2])));
            }
            auto const maps = drawn(scene, grid);
            auto const near_distance = static_cast<double>(scene.camera.near_distance);
            for (std::uint32_t row = 0; row < grid.height; ++row) {
                for (std::uint32_t column = 0; column < grid.width; ++column) {
                    auto const r = ray_through(scene.camera, grid, {row, column});
                    std::optional<hit> nearest;
                    posed_object const* shown = nullptr;
                    auto on_an_edge = false;
                    for (auto const& posed : scene.objects) {
                        auto const found = meet(r, posed.positions[0], posed.positions[1], posed.positions[2]);
                        if (!found || found->depth < near_distance) {
                            continue;
                        }
                        on_an_edge = on_an_edge || std::abs(found->edge_distance()) < 1e-7;
                        if (found->edge_distance() > 0 && (!nearest || found->depth < nearest->depth)) {
                            nearest = found;
                            shown = &posed;
                        }
                    }
                    if (on_an_edge) {
                        continue;
                    }
                    ++compared;
                    REQUIRE((maps.coverage(row, column) == 1) == nearest.has_value());
                    if (nearest) {
                        REQUIRE(maps.object(row, column) == shown->object.value);
                        REQUIRE(std::abs(static_cast<double>(maps.uv(row, column, 0)) - nearest->b) < 1e-6);
                        REQUIRE(std::abs(static_cast<double>(maps.uv(row, column, 1)) - nearest->c) < 1e-6);
                        REQUIRE(maps.depth(row, column) == doctest::Approx(nearest->depth).epsilon(1e-6));
                        auto behind = false;
                        for (auto const& p : shown->positions) {
                            behind = behind || -(scene.camera.view * glm::vec4(p, 1)).z < scene.camera.near_distance;
                        }
                        from_cut_triangles += behind;
                    }
                }
            }
        }
        CHECK(compared > 6 * grid.size() * 9 / 10);
        CHECK(from_cut_triangles > 1000);
    }

    TEST_CASE("neighbouring triangles draw each pixel once") {
        // A cut grid with jittered vertices and depths; some vertices and edges lie exactly on pixel centres.
        constexpr std::uint32_t cells = 10;
        grid_extents const grid{40, 40};
        camera const eye;
        image_plane const plane(eye, grid);
        mesh whole;
        for (std::uint32_t row = 0; row <= cells; ++row) {
            for (std::uint32_t column = 0; column <= cells; ++column) {
                auto const random = [&](std::uint32_t axis) {
                    return uniform_value(5, random_stream::test, {row, column, axis});
                };
                auto const inside = row > 0 && row < cells && column > 0 && column < cells;
                auto const jitter = [&](std::uint32_t axis) {
                    return inside ? std::round(4 * random(axis) - 2) / 2 : 0.0;
                };
                auto const depth = 2 + random(2);
                auto const x = plane.x_of((inside ? 4.0 * column + 0.5 : 4.4 * column - 2) + jitter(0));
                auto const y = plane.y_of((inside ? 4.0 * row + 0.5 : 4.4 * row - 2) + jitter(1));
                whole.positions.push_back(glm::vec3(glm::dvec3(x, y, -1) * depth));
                whole.uvs.push_back({0, 0});
            }
        }
        detail::append_grid_triangles(whole, 0, cells, cells);
        stack<int, 2> count({grid.height, grid.width});
        for (auto const& t : whole.triangles) {
            auto one = whole;
            one.triangles = {t};
            auto const maps = drawn({eye, {still(0, one)}}, grid);
            for (std::uint32_t row = 0; row < grid.height; ++row) {
                for (std::uint32_t column = 0; column < grid.width; ++column) {
                    count(row, column) += maps.coverage(row, column);
                }
            }
        }
        for (std::uint32_t row = 0; row < grid.height; ++row) {
            for (std::uint32_t column = 0; column < grid.width; ++column) {
                REQUIRE(count(row, column) == 1);
            }
        }
    }

    TEST_CASE("the nearer object hides the farther whatever their order") {
        auto const near_first = drawn({{}, {still(1, wall(2)), still(0, wall(3))}}, {4, 4});
        auto const far_first = drawn({{}, {still(0, wall(3)), still(1, wall(2))}}, {4, 4});
        CHECK(near_first.object(1, 2) == 1);
        CHECK(far_first.object(1, 2) == 1);
        CHECK(far_first.depth(1, 2) == doctest::Approx(2));
    }

    TEST_CASE("equally near surfaces go to the lower object and then to the earlier triangle") {
        CHECK(drawn({{}, {still(5, wall(2)), still(2, wall(2))}}, {4, 4}).object(1, 1) == 2);
        CHECK(drawn({{}, {still(2, wall(2)), still(5, wall(2))}}, {4, 4}).object(1, 1) == 2);
        auto twice = triangle({-9, -9, -2}, {9, -9, -2}, {0, 9, -2});
        append(twice, twice);
        for (std::size_t i = 3; i < 6; ++i) {
            twice.uvs[i] = {0.75f, 0.75f};
        }
        auto const first = drawn({{}, {still(0, twice)}}, {4, 4});
        std::swap(twice.triangles[0], twice.triangles[1]);
        auto const second = drawn({{}, {still(0, twice)}}, {4, 4});
        CHECK(first.uv(1, 1, 0) != 0.75f);
        CHECK(second.uv(1, 1, 0) == 0.75f);
    }

    TEST_CASE("both sides of a triangle are seen alike") {
        auto const front = drawn({{}, {still(0, triangle({-1, -1, -3}, {1, -1, -2}, {0, 1, -4}))}}, {16, 16});
        auto turned = triangle({-1, -1, -3}, {1, -1, -2}, {0, 1, -4});
        std::swap(turned.triangles[0].y, turned.triangles[0].z);
        auto const back = drawn({{}, {still(0, turned)}}, {16, 16});
        CHECK(front.covered() > 20);
        for (std::uint32_t row = 0; row < 16; ++row) {
            for (std::uint32_t column = 0; column < 16; ++column) {
                REQUIRE(front.coverage(row, column) == back.coverage(row, column));
                REQUIRE(front.uv(row, column, 0) == doctest::Approx(back.uv(row, column, 0)));
            }
        }
    }

    TEST_CASE("what is behind the eye or nearer than the near distance is not seen") {
        CHECK(drawn({{}, {still(0, wall(-3))}}, {8, 8}).covered() == 0);
        camera eye;
        eye.near_distance = 2.5f;
        CHECK(drawn({eye, {still(0, wall(2))}}, {8, 8}).covered() == 0);
        CHECK(drawn({eye, {still(0, wall(3))}}, {8, 8}).covered() == 64);
        // A wall that is too near shows what it would have hidden.
        auto const maps = drawn({eye, {still(0, wall(2)), still(1, wall(3))}}, {8, 8});
        CHECK(maps.object(3, 3) == 1);
    }

    TEST_CASE("a floor that passes under the eye is cut at the near distance and at the horizon") {
        camera eye;
        eye.near_distance = 1.5f;
        eye.vertical_fov = 1.6f;
        grid_extents const grid{32, 32};
        auto const floor = make_plane({2000, 2000});
        auto const maps = drawn({eye, {still(0, floor, glm::translate(glm::mat4(1), {0, -1, 0}))}}, grid);
        image_plane const plane(eye, grid);
        for (std::uint32_t row = 0; row < grid.height; ++row) {
            auto const y = plane.centre_of({row, 0}).y;
            auto const depth = -1 / y;
            auto const seen = y < 0 && depth >= 1.5 && depth < 1000;
            for (std::uint32_t column = 0; column < grid.width; ++column) {
                REQUIRE((maps.coverage(row, column) == 1) == seen);
                if (seen) {
                    REQUIRE(maps.depth(row, column) == doctest::Approx(depth).epsilon(1e-5));
                    REQUIRE(std::abs(maps.uv(row, column, 1) - (1000 - depth) / 2000) < 1e-5);
                }
            }
        }
        CHECK(maps.coverage(15, 0) == 0);
        CHECK(maps.coverage(31, 0) == 0);
        CHECK(maps.coverage(20, 0) == 1);
    }

    TEST_CASE("triangles without area draw nothing") {
        CHECK(drawn({{}, {still(0, triangle({-1, 0, -2}, {0, 0, -2}, {1, 0, -2}))}}, {9, 9}).covered() == 0);
        CHECK(drawn({{}, {still(0, triangle({0, 0, -2}, {0, 0, -2}, {1, 1, -2}))}}, {9, 9}).covered() == 0);
        CHECK(drawn({{}, {still(0, triangle({0, 0, -2}, {0, 0, -2}, {0, 0, -2}))}}, {9, 9}).covered() == 0);
        CHECK(drawn({{}, {still(0, triangle({-1, 0, -2}, {1, 0, -2}, {0, 0, -5}))}}, {9, 9}).covered() == 0); // edge on
    }

    TEST_CASE("UVs that leave the texture stay as they are") {
        auto surface = wall(4);
        for (auto& uv : surface.uvs) {
            uv = uv * 10.0f - 2.0f;
        }
        auto const maps = drawn({{}, {still(0, surface)}}, {6, 6});
        auto const inside = drawn({{}, {still(0, wall(4))}}, {6, 6});
        CHECK(maps.uv(0, 0, 0) > 1);
        CHECK(maps.uv(0, 0, 0) == doctest::Approx(inside.uv(0, 0, 0) * 10 - 2));
    }

    TEST_CASE("the background is zero whatever the memory held") {
        auto const maps =
            drawn({{}, {still(4, triangle({-0.1f, -0.1f, -2}, {0.1f, -0.1f, -2}, {0, 0.1f, -2}))}}, {8, 8});
        CHECK(maps.covered() > 0);
        CHECK(maps.coverage(0, 0) == 0);
        CHECK(maps.object(0, 0) == 0);
        CHECK(maps.uv(0, 0, 0) == 0);
        CHECK(maps.uv(0, 0, 1) == 0);
        CHECK(maps.depth(0, 0) == 0);
        CHECK(drawn({}, {3, 3}).covered() == 0);
    }

    TEST_CASE("what cannot be drawn is refused by name") {
        frame_maps maps({4, 4});
        posed_scene scene{{}, {still(6, wall(2))}};
        scene.objects[0].positions[2].y = std::numeric_limits<float>::quiet_NaN();
        CHECK_THROWS_WITH_AS(rasterize_frame(maps.view(), scene),
                             "rasterize: object 6 positions[2] is not finite, expected finite coordinates",
                             value_error);
        scene.objects[0].positions.pop_back();
        CHECK_THROWS_WITH_AS(rasterize_frame(maps.view(), scene), "rasterize: object 6 positions is [3], expected [4]",
                             shape_error);
        scene.objects[0].surface = nullptr;
        CHECK_THROWS_WITH_AS(rasterize_frame(maps.view(), scene),
                             "rasterize: object 6 surface is null, expected a mesh", value_error);

        auto broken = wall(2);
        broken.triangles[1].x = 4;
        CHECK_THROWS_WITH_AS(rasterize_frame(maps.view(), {{}, {still(0, broken)}}),
                             "rasterize: mesh.triangles[1] is [4, 3, 1], expected vertices below 4", value_error);

        posed_scene blind;
        blind.camera.near_distance = -1;
        CHECK_THROWS_WITH_AS(rasterize_frame(maps.view(), blind),
                             "rasterize: camera.near_distance is -1.000000, expected a finite distance above 0",
                             value_error);

        frame_maps other({4, 5});
        auto mixed = maps.view();
        mixed.depth = other.depth.view();
        CHECK_THROWS_WITH_AS(rasterize_frame(mixed, {}), "rasterize: depth is [4, 5], expected [4, 4]", shape_error);
        mixed = maps.view();
        mixed.uv = other.uv.view();
        CHECK_THROWS_WITH_AS(rasterize_frame(mixed, {}), "rasterize: uv is [4, 5, 2], expected [4, 4, 2]", shape_error);
    }
}
