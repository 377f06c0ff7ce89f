// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The weights of a texel's keyframes.
#include <genrender/blending/texel_weights.hpp>

#include <doctest/doctest.h>

#include <initializer_list>

using namespace genrender;

TEST_SUITE("blending/texel_weights") {
    TEST_CASE("[GR sec. 3.2] the unified texture is the mean of first fill and average") {
        static_assert(unified_weight(0, 1, 0.5) == 1);
        static_assert(unified_weight(0, 2, 0.5) == 0.75);
        static_assert(unified_weight(1, 2, 0.5) == 0.25);
        CHECK(unified_weight(0, 4, 0.5f) == doctest::Approx((1 + 0.25) / 2));
        CHECK(unified_weight(3, 4, 0.5f) == doctest::Approx(0.125));
    }
    TEST_CASE_TEMPLATE("weights sum to 1 for every share", Real, float, double) {
        for (std::size_t seen = 1; seen < 9; ++seen) {
            for (auto const share : {Real(0), Real(0.3), Real(0.5), Real(1)}) {
                Real sum = 0;
                for (std::size_t position = 0; position < seen; ++position) {
                    sum += unified_weight(position, seen, share);
                }
                CHECK(sum == doctest::Approx(1));
            }
        }
        CHECK(average_weight<Real>(4) == Real(0.25));
        CHECK(first_fill_weight<Real>(0) == 1);
        CHECK(first_fill_weight<Real>(1) == 0);
    }
}
