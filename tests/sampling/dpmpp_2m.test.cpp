// SPDX-License-Identifier: MIT
// [DPM++ alg. 2] DPM-Solver++(2M).
#include <genrender/sampling/dpmpp_2m.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;

TEST_SUITE("sampling/dpmpp_2m") {
    TEST_CASE("[DPM++ alg. 2] two steps by hand") {
        // D = sigma, from 8 at level 4, each step as long as the last in log sigma (h = h_last = log 2).
        // First step: 8 / 2 + 4 / 2 = 6. Second: x0 = 2 + (2 - 4) / 2 = 1, so 6 / 2 + 1 / 2 = 3.5.
        auto const level = [](double, double sigma) { return sigma; };
        CHECK(dpmpp_2m(level, 8.0, std::vector{4.0, 2.0, 1.0}) == doctest::Approx(3.5).epsilon(1e-15));
        // Second step four times as long: x0 = 2 + 4 / 2 (2 - 4) = -2, so 6 / 16 - 2 * 15 / 16 = -1.5.
        CHECK(dpmpp_2m(level, 8.0, std::vector{4.0, 2.0, 0.125}) == doctest::Approx(-1.5).epsilon(1e-14));
    }

    TEST_CASE("the last step to level 0 forgets the past") {
        // Its result is the clean estimate itself, however different the one before was.
        auto const level = [](double, double sigma) { return sigma; };
        CHECK(dpmpp_2m(level, 8.0, std::vector{4.0, 1.0, 0.0}) == 1.0);
    }
}
