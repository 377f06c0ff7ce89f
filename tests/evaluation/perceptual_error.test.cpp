// SPDX-License-Identifier: MIT
// Features that go along with a surface are alike, and what they are interpolated to is known by hand.
#include <genrender/evaluation/perceptual_error.hpp>

#include <genrender/core/stack.hpp>
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

using namespace genrender;
using genrender::testing::random_stack;

TEST_SUITE("evaluation/perceptual_error") {
    /// A strip that slides by one pixel a frame under a window of four pixels: pixel p of frame i shows point p + i. The
    /// points of even number are of object 0, the others of object 1.
    struct sliding_features {
        struct point_type {
            std::uint32_t number;
            object_index object;
        };
        std::size_t frames = 2;
        std::size_t frame_count() const { return frames; }
        grid_extents grid() const { return {1, 4}; }
        std::optional<point_type> point_at(frame_index i, token_index t) const {
            return point_type{t.value + i.value, {(t.value + i.value) % 2}};
        }
        std::optional<token_index> token_at(frame_index i, point_type const& point) const {
            auto const is_seen = point.number >= i.value && point.number < i.value + 4;
            return is_seen ? std::optional(token_index{point.number - i.value}) : std::nullopt;
        }
    };

    TEST_CASE_TEMPLATE("features of surface points have no error, at any interval and length", Real, float, double) {
        auto const points = random_stack<Real, 2>({8, 5}, 3);
        stack<Real, 4> features({3, 5, 1, 4});
        for (std::uint32_t i = 0; i < 3; ++i) {
            for (std::size_t c = 0; c < 5; ++c) {
                for (std::size_t p = 0; p < 4; ++p) {
                    features(i, c, 0, p) = static_cast<Real>(i + 1) * points(p + i, c);
                }
            }
        }
        auto const errors = perceptual_errors(features.view(), sliding_features{3}, std::array<std::size_t, 2>{1, 2});
        CHECK(*errors[0].error == doctest::Approx(0).scale(1).epsilon(1e-6));
        CHECK(*errors[1].error == doctest::Approx(0).scale(1).epsilon(1e-6));
        CHECK(errors[0].pairs == 6);
        CHECK(errors[1].pairs == 2);
    }

    TEST_CASE("one less the cosine between features on a coarser grid, interpolated to the pixels, by hand") {
        // Places lie at pixels 0.5 and 2.5: pixels 0, 1, 2, 3 read (1, 0), (3/4, 1/4), (1/4, 3/4) and (0, 1) of frame 0.
        stack<double, 4> features({2, 2, 1, 2});
        features(0, 0, 0, 0) = features(0, 1, 0, 1) = 1;
        features(1, 0, 0, 0) = features(1, 0, 0, 1) = 2; // frame 1 reads (2, 0) everywhere
        auto const errors = perceptual_errors(features.view(), sliding_features{}, std::array<std::size_t, 1>{1});
        auto const cosine = [](double x, double y) { return x / std::hypot(x, y); };
        // Pixels 0, 1 and 2 of frame 1 show points 1, 2 and 3, which are pixels 1, 2 and 3 of frame 0.
        CHECK(*errors[0].error == doctest::Approx(1 - (cosine(0.75, 0.25) + cosine(0.25, 0.75) + 0) / 3));
    }

    TEST_CASE("opposite features have an error of two, absent ones of one") {
        stack<double, 4> features({2, 1, 1, 1});
        features(0, 0, 0, 0) = 3;
        features(1, 0, 0, 0) = -1;
        CHECK(*perceptual_errors(features.view(), sliding_features{}, std::array<std::size_t, 1>{1})[0].error == 2.0);
        features(1, 0, 0, 0) = 0;
        CHECK(*perceptual_errors(features.view(), sliding_features{}, std::array<std::size_t, 1>{1})[0].error == 1.0);
    }

    TEST_CASE("only pairs of objects that count are compared") {
        auto const features = random_stack<double, 4>({2, 3, 1, 4}, 8);
        auto const odd = [](object_index object) { return object.value == 1; };
        auto const none = [](object_index) { return false; };
        std::array<std::size_t, 1> const next{1};
        CHECK(perceptual_errors(features.view(), sliding_features{}, next, odd)[0].pairs == 2);
        CHECK_FALSE(perceptual_errors(features.view(), sliding_features{}, next, none)[0].error);
    }

    TEST_CASE("other frames, grids without places and an interval of zero are refused") {
        std::array<std::size_t, 1> const next{1};
        CHECK_THROWS_WITH_AS(perceptual_errors(stack<float, 4>({3, 2, 1, 4}).view(), sliding_features{}, next),
                             "perceptual_errors: features is [3, 2, 1, 4], expected [2, 2, 1, 4]", shape_error);
        CHECK_THROWS_WITH_AS(perceptual_errors(stack<float, 4>({2, 2, 0, 4}).view(), sliding_features{}, next),
                             "perceptual_errors: features is [2, 2, 0, 4], expected [2, 2, 1, 4]", shape_error);
        CHECK_THROWS_WITH_AS(
            perceptual_errors(stack<float, 4>({2, 2, 1, 4}).view(), sliding_features{}, std::array<std::size_t, 1>{0}),
            "perceptual_errors: interval is 0, expected at least 1", value_error);
    }
}
