// SPDX-License-Identifier: MIT
// Gains by hand, and how rarely chance alone makes one.
#include <genrender/normalization/supported_gain.hpp>

#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

using namespace genrender;

TEST_SUITE("normalization/supported_gain") {
    TEST_CASE_TEMPLATE("a difference loses its standard errors by hand", Real, float, double) {
        // 51 and 101 pixels: e^2 = 1 / 100 + 1 / 200 = 0.015.
        auto const e = std::sqrt(0.015);
        CHECK(supported_gain(Real(1), 51, 2, 101, 0, 10) == doctest::Approx(2));
        CHECK(supported_gain(Real(1), 51, 2, 101, 1, 10) == doctest::Approx(2 * std::exp(-e)));
        CHECK(supported_gain(Real(1), 51, 2, 101, 2, 10) == doctest::Approx(2 * std::exp(-2 * e)));
        CHECK(supported_gain(Real(2), 51, 1, 101, 2, 10) == doctest::Approx(0.5 * std::exp(2 * e)));
        CHECK(supported_gain(Real(3), 51, 3, 101, 2, 10) == 1);
    }
    TEST_CASE_TEMPLATE("what pixels do not support changes nothing and fewer pixels support less", Real, float,
                       double) {
        CHECK(supported_gain(Real(1), 51, Real(1.2), 101, 2, 10) == 1);
        CHECK(supported_gain(Real(1), 5001, Real(1.2), 10001, 2, 10) > Real(1.15));
        CHECK(supported_gain(Real(1), 2, 3, 2, 2, 10) == 1); // e = 1: two errors are more than log 3
    }
    TEST_CASE_TEMPLATE("however flat a background is the gain is bounded both ways", Real, float, double) {
        CHECK(supported_gain(Real(0.003), 1000, 1, 1000, 2, Real(1.1)) == doctest::Approx(1.1));
        CHECK(supported_gain(Real(1), 1000, Real(0.003), 1000, 2, Real(1.1)) == doctest::Approx(1 / 1.1));
        CHECK(supported_gain(Real(0.003), 1000, 1, 1000, 2, 1) == 1);
    }
    TEST_CASE("samples of equal deviation get a gain other than 1 in about one of twenty") {
        std::size_t changed = 0;
        constexpr std::uint32_t trials = 2000;
        constexpr std::uint32_t pixels = 60;
        for (std::uint32_t trial = 0; trial < trials; ++trial) {
            double deviation[2];
            for (std::uint32_t which = 0; which < 2; ++which) {
                double sum = 0;
                double squares = 0;
                for (std::uint32_t n = 0; n < pixels; ++n) {
                    auto const value = normal_value(3, random_stream::test, {trial, which, n});
                    sum += value;
                    squares += value * value;
                }
                deviation[which] = std::sqrt((squares - sum * sum / pixels) / (pixels - 1));
            }
            changed += supported_gain(deviation[0], pixels, deviation[1], pixels, 2, 10) == 1 ? 0U : 1U;
        }
        MESSAGE(changed, " of ", trials);
        CHECK(changed > trials * 3 / 100);
        CHECK(changed < trials * 7 / 100);
    }
    TEST_CASE("deviations of nothing are refused") {
        CHECK_THROWS_WITH_AS(supported_gain(0.0, 9, 1, 9, 2, 2),
                             "supported_gain: from is 0.000000, expected a number above 0", value_error);
        CHECK_THROWS_AS(supported_gain(1.0, 9, -1, 9, 2, 2), value_error);
        CHECK_THROWS_WITH_AS(supported_gain(1.0, 1, 1, 9, 2, 2),
                             "supported_gain: from_pixels is 1, expected at least 2", value_error);
        CHECK_THROWS_AS(supported_gain(1.0, 9, 1, 1, 2, 2), value_error);
    }
}
