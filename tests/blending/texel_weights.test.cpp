// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The weights of a texel's keyframes.
#include <genrender/blending/texel_weights.hpp>

#include <doctest/doctest.h>

#include <initializer_list>

using namespace genrender;

TEST_SUITE("blending/texel_weights") {
    TEST_CASE("[GR sec. 3.2] the unified texture is the mean of first fill and average") {
        static_assert(unified_weight(0, average_weight<double>(1), 0.5) == 1);
        static_assert(unified_weight(0, average_weight<double>(2), 0.5) == 0.75);
        static_assert(unified_weight(1, average_weight<double>(2), 0.5) == 0.25);
        CHECK(unified_weight(0, average_weight<float>(4), 0.5f) == doctest::Approx((1 + 0.25) / 2));
        CHECK(unified_weight(3, average_weight<float>(4), 0.5f) == doctest::Approx(0.125));
    }
    TEST_CASE_TEMPLATE("an average by quality shares in proportion to it", Real, float, double) {
        CHECK(average_weight_by_quality<Real>(3, 4, 2) == Real(0.75));
        CHECK(average_weight_by_quality<Real>(1, 4, 2) == Real(0.25));
        CHECK(average_weight_by_quality<Real>(0, 4, 2) == 0);
        CHECK(average_weight_by_quality<Real>(7, 7, 1) == 1);
        // The first keyframe keeps its first fill, however badly it sees.
        CHECK(unified_weight(0, average_weight_by_quality<Real>(0, 4, 2), Real(0.5)) == Real(0.5));
        CHECK(unified_weight(1, average_weight_by_quality<Real>(4, 4, 2), Real(0.5)) == Real(0.5));
    }
    TEST_CASE_TEMPLATE("keyframes of which no quality is known are averaged alike", Real, float, double) {
        CHECK(average_weight_by_quality<Real>(0, 0, 4) == average_weight<Real>(4));
        CHECK(average_weight_by_quality<Real>(0, 0, 1) == 1);
    }
    TEST_CASE_TEMPLATE("weights sum to 1 for every share", Real, float, double) {
        for (std::size_t seen = 1; seen < 9; ++seen) {
            for (auto const share : {Real(0), Real(0.3), Real(0.5), Real(1)}) {
                Real sum = 0;
                Real sum_by_quality = 0;
                for (std::size_t position = 0; position < seen; ++position) {
                    sum += unified_weight(position, average_weight<Real>(seen), share);
                    // Qualities 0, 1, ..., seen - 1.
                    auto const quality = average_weight_by_quality<Real>(
                        static_cast<double>(position), static_cast<double>(seen * (seen - 1) / 2), seen);
                    sum_by_quality += unified_weight(position, quality, share);
                }
                CHECK(sum == doctest::Approx(1));
                CHECK(sum_by_quality == doctest::Approx(1));
            }
        }
        CHECK(average_weight<Real>(4) == Real(0.25));
        CHECK(first_fill_weight<Real>(0) == 1);
        CHECK(first_fill_weight<Real>(1) == 0);
    }
}
