// SPDX-License-Identifier: MIT
// 2^x beside the standard library's.
#include <genrender/core/exponential.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace genrender;

namespace {

/// 2^x of one number, in every lane.
template <class Real>
Real power_of_2(Real x) {
    Real out[detail::lane_count<Real>];
    detail::store(out, detail::exponential_2<Real>(detail::spread(x)));
    CHECK((std::isnan(x) || std::equal(out + 1, out + detail::lane_count<Real>, out)));
    return out[0];
}

} // namespace

TEST_SUITE("core/exponential") {
    TEST_CASE_TEMPLATE("it is within an ulp and a half of the standard library over all of its range", Real, float,
                       double) {
        auto const greatest = static_cast<Real>(std::numeric_limits<Real>::max_exponent - 1);
        auto const least = static_cast<Real>(std::numeric_limits<Real>::min_exponent);
        double worst = 0;
        for (int i = 0; i < 20000; ++i) {
            auto const x = least + (greatest - least) * static_cast<Real>(i) / Real{20000};
            auto const exact = std::exp2(static_cast<long double>(x));
            worst = std::max(worst, static_cast<double>(std::abs((power_of_2(x) - exact) / exact)));
        }
        CHECK(worst < 1.5 * static_cast<double>(std::numeric_limits<Real>::epsilon()));
    }

    TEST_CASE_TEMPLATE("whole numbers are powers of 2 to the last bit", Real, float, double) {
        for (int n = -100; n <= 100; ++n) {
            CHECK(power_of_2(static_cast<Real>(n)) == std::ldexp(Real{1}, n));
        }
    }

    TEST_CASE_TEMPLATE("what lies far below counts as next to nothing and never as less", Real, float, double) {
        auto const infinity = std::numeric_limits<Real>::infinity();
        for (auto const x : {Real{-1e4}, std::numeric_limits<Real>::lowest(), -infinity}) {
            CHECK(power_of_2(x) > 0);
            CHECK(power_of_2(x) < 3 * std::numeric_limits<Real>::min());
        }
    }

    TEST_CASE_TEMPLATE("NaN stays NaN", Real, float, double) {
        CHECK(std::isnan(power_of_2(std::numeric_limits<Real>::quiet_NaN())));
    }
}
