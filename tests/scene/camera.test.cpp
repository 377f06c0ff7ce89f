// SPDX-License-Identifier: MIT
// What a camera sees and where its pixels lie.
#include <genrender/scene/camera.hpp>

#include <doctest/doctest.h>

#include <glm/vec4.hpp>

#include <array>
#include <limits>

namespace {

using namespace genrender;

glm::vec3 in_camera_space(camera const& eye, glm::vec3 p) { return glm::vec3(eye.view * glm::vec4(p, 1)); }

} // namespace

TEST_SUITE("scene/camera") {
    TEST_CASE("look_at puts the target straight ahead and up upwards") {
        auto const eye = look_at({3, 2, 5}, {1, 1, 1}, 0.8f);
        auto const ahead = in_camera_space(eye, {1, 1, 1});
        CHECK(ahead.x == doctest::Approx(0).epsilon(1e-5));
        CHECK(ahead.y == doctest::Approx(0).epsilon(1e-5));
        CHECK(ahead.z == doctest::Approx(-std::sqrt(21.0)));
        CHECK(in_camera_space(eye, {1, 2, 1}).y > 0);
        auto const position = position_of(eye);
        CHECK(position.x == doctest::Approx(3));
        CHECK(position.y == doctest::Approx(2));
        CHECK(position.z == doctest::Approx(5));
    }

    TEST_CASE("an eye on the z axis that looks along -z sees +x on the right") {
        auto const eye = look_at({0, 0, 4}, {0, 0, 0}, 0.8f);
        CHECK(in_camera_space(eye, {1, 0, 0}).x == doctest::Approx(1));
    }

    TEST_CASE("a view without a direction is refused by name") {
        CHECK_THROWS_WITH_AS(look_at({1, 2, 3}, {1, 2, 3}, 0.8f),
                             "look_at: target is the camera's position, expected another point", value_error);
        CHECK_THROWS_WITH_AS(look_at({0, 3, 0}, {0, 0, 0}, 0.8f),
                             "look_at: up is along the view, expected another direction", value_error);
        CHECK_THROWS_WITH_AS(look_at({0, 0, 3}, {0, 0, 0}, 0),
                             "look_at: camera.vertical_fov is 0.000000, expected an angle between 0 and pi",
                             value_error);
    }

    TEST_CASE("a camera that cannot see is refused by name") {
        camera eye;
        CHECK_NOTHROW(validate(eye));
        eye.vertical_fov = 3.5f;
        CHECK_THROWS_WITH_AS(validate(eye, "draw"),
                             "draw: camera.vertical_fov is 3.500000, expected an angle between 0 and pi", value_error);
        eye = {};
        eye.near_distance = 0;
        CHECK_THROWS_WITH_AS(validate(eye),
                             "validate: camera.near_distance is 0.000000, expected a finite distance above 0",
                             value_error);
        eye = {};
        eye.view[2][1] = std::numeric_limits<float>::quiet_NaN();
        CHECK_THROWS_WITH_AS(validate(eye), "validate: camera.view is not finite, expected a finite matrix",
                             value_error);
    }

    TEST_CASE("a fitted camera sees the whole box in wide and tall images and no smaller than it must") {
        bounds const box{{-1, 0, -2}, {3, 2, 1}};
        for (auto const aspect : {0.5f, 1.0f, 2.0f}) {
            auto const eye = fit_camera(box, {-1, -0.6f, -2}, 0.7f, aspect);
            auto const half_height = std::tan(0.35f);
            for (int corner = 0; corner < 8; ++corner) {
                auto const p = in_camera_space(eye, {corner & 1 ? box.lower.x : box.upper.x,
                                                     corner & 2 ? box.lower.y : box.upper.y,
                                                     corner & 4 ? box.lower.z : box.upper.z});
                CHECK(-p.z > eye.near_distance);
                CHECK(std::abs(p.y / p.z) <= half_height);
                CHECK(std::abs(p.x / p.z) <= half_height * aspect);
            }
            // The sphere around the box touches the narrower side of the view.
            auto const centre = in_camera_space(eye, box.centre());
            auto const half_angle = std::atan(half_height * std::min(1.0f, aspect));
            CHECK(-centre.z * std::sin(half_angle) == doctest::Approx(box.radius()));
        }
        CHECK_THROWS_WITH_AS(fit_camera({}, {0, 0, -1}, 0.7f, 1),
                             "fit_camera: box is a single point, expected an extent above 0", value_error);
        CHECK_THROWS_WITH_AS(fit_camera(box, {0, 0, -1}, 0.7f, 0),
                             "fit_camera: aspect is 0.000000, expected width / height above 0", value_error);
        CHECK_THROWS_WITH_AS(fit_camera(box, {0, 0, 0}, 0.7f, 1), "fit_camera: direction is zero, expected a direction",
                             value_error);
    }

    TEST_CASE("pixel centres lie half a pixel inside and row 0 is the top") {
        camera eye;
        eye.vertical_fov = 1.2f;
        image_plane const plane(eye, {4, 6});
        auto const half_height = std::tan(static_cast<double>(1.2f) / 2);
        auto const pixel_size = half_height / 2;
        auto const first = plane.centre_of({0, 0});
        CHECK(first.x == doctest::Approx(-2.5 * pixel_size));
        CHECK(first.y == doctest::Approx(1.5 * pixel_size));
        auto const last = plane.centre_of({3, 5});
        CHECK(last.x == doctest::Approx(2.5 * pixel_size));
        CHECK(last.y == doctest::Approx(-1.5 * pixel_size));
        CHECK(plane.column_of(plane.x_of(4.25)) == doctest::Approx(4.25));
        CHECK(plane.row_of(plane.y_of(1.75)) == doctest::Approx(1.75));
    }
}
