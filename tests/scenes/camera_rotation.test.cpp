// SPDX-License-Identifier: MIT
// Nothing moves but the camera, and the camera goes all the way around.
#include <examples/scenes/camera_rotation.hpp>

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

TEST_SUITE("scenes/camera_rotation") {
    using namespace genrender;

    TEST_CASE("objects stand still and none sinks into the ground") {
        scenes::camera_rotation const scene(9);
        auto const first = scene.frame({0}), last = scene.frame({8});
        REQUIRE(first.objects.size() == last.objects.size());
        CHECK(first.objects.size() >= 8);
        for (std::size_t i = 0; i < first.objects.size(); ++i) {
            CHECK(first.objects[i].positions == last.objects[i].positions);
            for (auto const& p : first.objects[i].positions) {
                REQUIRE(p.y >= -1e-3f);
            }
        }
    }

    TEST_CASE("the camera goes in equal steps at one distance and one height") {
        scenes::camera_rotation const whole(12);
        auto const first = position_of(whole.frame({0}).camera);
        auto const radius = std::hypot(first.x, first.z);
        auto const chord = 2 * radius * std::sin(std::numbers::pi_v<float> / 12);
        for (std::uint32_t i = 0; i < 12; ++i) {
            auto const here = position_of(whole.frame({i}).camera);
            auto const next = position_of(whole.frame({(i + 1) % 12}).camera); // after the last comes the first
            CHECK(std::hypot(here.x, here.z) == doctest::Approx(radius).epsilon(1e-4));
            CHECK(here.y == doctest::Approx(first.y).epsilon(1e-4));
            CHECK(glm::length(next - here) == doctest::Approx(chord).epsilon(1e-3));
        }
    }

    TEST_CASE("a part of a turn is a part of the way") {
        scenes::camera_rotation const part(4, 0.8f);
        auto const first = position_of(part.frame({0}).camera), second = position_of(part.frame({1}).camera);
        auto const radius = std::hypot(first.x, first.z);
        CHECK(glm::length(second - first) == doctest::Approx(2 * radius * std::sin(0.1)).epsilon(1e-3));
    }
}
