// SPDX-License-Identifier: MIT
// Bits say what is finite, at both ends of the range.
#include <genrender/core/finite.hpp>

#include <doctest/doctest.h>

#include <array>
#include <limits>

TEST_SUITE("core/finite") {
    using namespace genrender;

    TEST_CASE_TEMPLATE("numbers are finite and infinities and NaN are not", Real, float, double) {
        using limits = std::numeric_limits<Real>;
        for (auto const x : {Real(0), Real(-0.0), Real(1), Real(-3.5), limits::denorm_min(), limits::min(),
                             limits::max(), limits::lowest()}) {
            CAPTURE(x);
            CHECK(is_finite(x));
            CHECK_FALSE(is_nan(x));
        }
        for (auto const x : {limits::infinity(), -limits::infinity()}) {
            CHECK_FALSE(is_finite(x));
            CHECK_FALSE(is_nan(x));
        }
        for (auto const x : {limits::quiet_NaN(), -limits::quiet_NaN(), limits::signaling_NaN()}) {
            CHECK_FALSE(is_finite(x));
            CHECK(is_nan(x));
        }
    }

    TEST_CASE("a point is finite if all of its coordinates are") {
        CHECK(is_finite(std::array<float, 3>{0, 1, 2}));
        CHECK_FALSE(is_finite(std::array<float, 3>{0, 1, std::numeric_limits<float>::infinity()}));
        CHECK_FALSE(is_finite(std::array<double, 2>{std::numeric_limits<double>::quiet_NaN(), 1}));
    }

    TEST_CASE("known before the program runs") {
        static_assert(is_finite(1.0F) && !is_finite(std::numeric_limits<double>::infinity()));
        static_assert(is_nan(std::numeric_limits<float>::quiet_NaN()) && !is_nan(2.0));
    }
}
