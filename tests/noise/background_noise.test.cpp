// SPDX-License-Identifier: MIT
// [GR sec. 3.3] Noise of the screen, and the directions of the surroundings.
#include <genrender/noise/background_noise.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>

using namespace genrender;

TEST_SUITE("noise/background_noise") {
    TEST_CASE("a fixed screen is the same in every frame and an independent one is not") {
        auto const fixed = screen_noise(4, background_noise::fixed, {0}, 0, 17, 2);
        CHECK(screen_noise(4, background_noise::fixed, {9}, 0, 17, 2) == fixed);
        auto const independent = screen_noise(4, background_noise::independent, {0}, 0, 17, 2);
        CHECK(independent != fixed);
        CHECK(screen_noise(4, background_noise::independent, {9}, 0, 17, 2) != independent);
    }

    TEST_CASE("pixels channels steps and seeds have values of their own") {
        auto const value = screen_noise(4, background_noise::fixed, {0}, 0, 17, 2);
        CHECK(screen_noise(4, background_noise::fixed, {0}, 0, 18, 2) != value);
        CHECK(screen_noise(4, background_noise::fixed, {0}, 0, 17, 3) != value);
        CHECK(screen_noise(4, background_noise::fixed, {0}, 1, 17, 2) != value);
        CHECK(screen_noise(5, background_noise::fixed, {0}, 0, 17, 2) != value);
    }

    TEST_CASE("a ray is a unit direction with its change to the pixels beside and below") {
        environment_rays const rays{[](frame_index i, double row, double column) {
            return std::array<double, 3>{2 * column, 2 * row, 2.0 + i.value};
        }};
        auto const ray = rays.at({1}, {3, 5});
        auto const middle = std::hypot(11.0, 7.0, 3.0);
        CHECK(ray.direction[0] == doctest::Approx(11 / middle));
        CHECK(ray.direction[1] == doctest::Approx(7 / middle));
        CHECK(ray.direction[2] == doctest::Approx(3 / middle));
        CHECK(ray.footprint.across[0] == doctest::Approx(13 / std::hypot(13.0, 7.0, 3.0) - 11 / middle));
        CHECK(ray.footprint.down[1] == doctest::Approx(9 / std::hypot(11.0, 9.0, 3.0) - 7 / middle));
    }

    TEST_CASE("directions that are none are refused with a sentence") {
        CHECK_THROWS_WITH_AS(environment_rays{}.at({0}, {0, 0}),
                             "environment_rays: direction is empty, expected a function", value_error);
        environment_rays const nowhere{[](frame_index, double, double) { return std::array<double, 3>{}; }};
        CHECK_THROWS_WITH_AS(nowhere.at({0}, {0, 0}),
                             "environment_rays: length of direction is 0.000000, expected a finite number above 0",
                             value_error);
        environment_rays const lost{[](frame_index, double, double) {
            return std::array<double, 3>{std::numeric_limits<double>::quiet_NaN(), 0, 1};
        }};
        CHECK_THROWS_AS(lost.at({0}, {0, 0}), value_error);
    }
}
