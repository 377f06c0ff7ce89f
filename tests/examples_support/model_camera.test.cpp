// SPDX-License-Identifier: MIT
// Cameras that see the whole of a model.
#include <examples/support/model_camera.hpp>

#include <doctest/doctest.h>

#include <numbers>

using namespace genrender;
using namespace genrender::examples;

namespace {

/// The largest |x| / half width and |y| / half height at which the points are seen; all must be in front.
glm::vec2 reach(camera const& eye, std::vector<glm::vec3> const& points, float aspect) {
    glm::vec2 largest(0);
    for (auto const& point : points) {
        auto const p = glm::vec3(eye.view * glm::vec4(point, 1));
        CHECK(-p.z > eye.near_distance);
        auto const t = std::tan(eye.vertical_fov / 2);
        largest = glm::max(largest, glm::abs(glm::vec2(p.x / aspect, p.y)) / (-p.z * t));
    }
    return largest;
}

std::vector<glm::vec3> const lopsided{{0, 0, 0}, {5, 0.5f, 0}, {1, 3, -2}, {4, 1, 7}, {-1, -0.25f, 0.5f}};

} // namespace

TEST_SUITE("examples_support/model_camera") {
    TEST_CASE("a fitted camera sees all points within nine tenths and as near as can be") {
        for (float const aspect : {0.5f, 1.0f, 1.7778f}) {
            for (float const azimuth : {0.0f, 0.5f, 2.0f, 4.0f}) {
                auto const eye = fit_points(lopsided, view_direction(azimuth, 0.3f), 0.6f, aspect);
                auto const r = reach(eye, lopsided, aspect);
                CHECK(std::max(r.x, r.y) == doctest::Approx(0.9).epsilon(1e-3));
                CHECK(count_seen(eye, lopsided, aspect) == lopsided.size());
            }
        }
    }

    TEST_CASE("azimuth 0 looks from +z and a quarter turn from +x and elevation from above") {
        auto const front = view_direction(0, 0);
        CHECK(front.z == doctest::Approx(-1));
        auto const side = view_direction(std::numbers::pi_v<float> / 2, 0);
        CHECK(side.x == doctest::Approx(-1));
        CHECK(view_direction(0, 0.5f).y < 0);
    }

    TEST_CASE("cameras at the orbit distance see all points from every side") {
        glm::vec3 const centre(2, 1, 2.5f);
        auto const distance = orbit_distance(lopsided, centre, 0.3f, 0.6f, 1);
        auto widest = 0.0f;
        for (int i = 0; i < 100; ++i) {
            auto const direction = view_direction(static_cast<float>(i) * 0.0628f, 0.3f);
            auto eye = look_at(centre - distance * direction, centre, 0.6f);
            eye.near_distance = 1e-3f;
            auto const r = reach(eye, lopsided, 1);
            widest = std::max({widest, r.x, r.y});
        }
        CHECK(widest < 0.91f);
        CHECK(widest > 0.85f);
    }

    TEST_CASE("a file's camera keeps its place and its height unless the image is narrower") {
        aiCamera source;
        source.mPosition = {0, 0, 1};
        source.mLookAt = {0, 0, -2};
        source.mUp = {0, 3, 0};
        source.mAspect = 2;
        source.mHorizontalFOV = 2 * std::atan(0.5f);
        glm::mat4 to_world(10); // a node that is ten times as large
        to_world[3] = {0, 5, 0, 1};
        auto const wide = file_camera(source, to_world, 3, 0.1f);
        CHECK(position_of(wide).y == doctest::Approx(5));
        CHECK(position_of(wide).z == doctest::Approx(10));
        CHECK(std::tan(wide.vertical_fov / 2) == doctest::Approx(0.25));
        auto const square = file_camera(source, to_world, 1, 0.1f);
        CHECK(std::tan(square.vertical_fov / 2) == doctest::Approx(0.5));
    }

    TEST_CASE("points behind the eye or beside the image are not seen") {
        camera eye; // at the origin, along -z
        eye.vertical_fov = std::numbers::pi_v<float> / 2;
        std::vector<glm::vec3> const points{{0, 0, -1}, {0, 0, 1}, {0, 2, -1}, {1.5f, 0, -1}};
        CHECK(count_seen(eye, points, 1) == 1);
        CHECK(count_seen(eye, points, 2) == 2);
    }
}
