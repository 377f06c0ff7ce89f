// SPDX-License-Identifier: MIT
// Mean cosines of pairs of frames by hand.
#include <genrender/evaluation/frame_consistency.hpp>

#include <doctest/doctest.h>

#include "support/colour_embedder.hpp"
#include <genrender/testing/random_stack.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>

using namespace genrender;
using genrender::testing::random_stack;

TEST_SUITE("evaluation/frame_consistency") {
    TEST_CASE_TEMPLATE("[GR sec. 4] vectors that turn by 30 degrees a frame", Real, float, double) {
        stack<Real, 2> turning({7, 2});
        for (std::size_t i = 0; i < 7; ++i) {
            auto const angle = static_cast<double>(i) * std::numbers::pi / 6;
            turning(i, 0) = static_cast<Real>(2 * std::cos(angle));
            turning(i, 1) = static_cast<Real>(2 * std::sin(angle));
        }
        CHECK(*frame_consistency(turning.view()) == doctest::Approx(std::sqrt(3.0) / 2));
        CHECK(*frame_consistency(turning.view(), 2) == doctest::Approx(0.5));
        CHECK(*frame_consistency(turning.view(), 6) == doctest::Approx(-1));
    }

    TEST_CASE_TEMPLATE("[GR sec. 4] the mean runs over consecutive pairs alone", Real, float, double) {
        // Directions x, x, y: cosines 1 and 0; frames 0 and 2 are no neighbours.
        stack<Real, 2> vectors({3, 2});
        vectors(0, 0) = 1;
        vectors(1, 0) = 5;
        vectors(2, 1) = 2;
        CHECK(*frame_consistency(vectors.view()) == doctest::Approx(0.5));
        CHECK(*frame_consistency(vectors.view(), 2) == doctest::Approx(0));
    }

    TEST_CASE("[GR sec. 4] frames that do not change are wholly consistent") {
        stack<float, 4> images({4, 3, 2, 2});
        for (std::size_t e = 0; e < images.size(); ++e) {
            images.data()[e] = 0.1F + 0.05F * static_cast<float>(e % 12);
        }
        auto const embeddings = embed_frames(genrender::testing::colour_embedder<float>{}, images);
        CHECK(*frame_consistency(embeddings.view(), 3) == doctest::Approx(1));
    }

    TEST_CASE("an animation without such a pair has no consistency") {
        auto const vectors = random_stack<float, 2>({3, 4}, 1);
        CHECK(frame_consistency(vectors.view(), 2).has_value());
        CHECK_FALSE(frame_consistency(vectors.view(), 3).has_value());
        CHECK_FALSE(frame_consistency(stack<float, 2>({0, 4}).view()).has_value());
        CHECK_THROWS_WITH_AS(frame_consistency(vectors.view(), 0),
                             "frame_consistency: interval is 0, expected at least 1", value_error);
    }
}
