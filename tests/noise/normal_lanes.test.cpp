// SPDX-License-Identifier: MIT
// Many values of N(0, 1) at once are those that come one by one.
#include <genrender/noise/normal_lanes.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

using namespace genrender;

TEST_SUITE("noise/normal_lanes") {
    TEST_CASE("values are those of the plain transform to a few units in the last place") {
        double worst = 0;
        std::array<double, 16> values{};
        for (std::uint32_t number = 0; number < 20000; ++number) {
            std::array<std::array<std::uint32_t, 4>, 4> counters{};
            for (std::uint32_t n = 0; n < 4; ++n) {
                counters[n] = {number, n, 2, 0};
            }
            normals_of(counters, {number * 7, 11}, values.data());
            for (std::size_t n = 0; n < 4; ++n) {
                auto const expected = four_normals_of(philox(counters[n], {number * 7, 11}));
                for (std::size_t j = 0; j < 4; ++j) {
                    worst = std::max(worst, std::abs(values[4 * n + j] - expected[j]));
                }
            }
        }
        CHECK(worst < 2e-14);
    }

#if defined(__GNUC__)
    TEST_CASE("the ends of the range and all eighths of a turn are right") {
        using pairs = detail::normal_pairs;
        std::array<std::uint32_t, 4> const radii{0, 1, 0x7FFFFFFFU, 0xFFFFFFFFU};
        for (auto const radius : radii) {
            for (std::uint64_t angle = 0; angle < 0x100000000U; angle += 0x0FFFFFFFU) {
                auto const made = pairs::of(pairs::words{} + std::uint64_t{radius}, pairs::words{} + angle);
                auto const bits = static_cast<std::uint32_t>(angle);
                auto const expected = four_normals_of({radius, bits, radius, bits});
                CHECK(made[0][0] == doctest::Approx(expected[0]).epsilon(1e-13));
                CHECK(made[1][pairs::lanes - 1] == doctest::Approx(expected[1]).epsilon(1e-13));
            }
        }
    }
#endif
}
