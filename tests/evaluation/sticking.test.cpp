// SPDX-License-Identifier: MIT
// Paint that goes along, paint that stays on the screen, and frames that have nothing to do with each other.
#include <genrender/evaluation/sticking.hpp>

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

TEST_SUITE("evaluation/sticking") {
    /// A strip that slides by `speed` pixels a frame under a window of `width`; of one object but for its first points.
    struct moving_strip {
        struct point_type {
            std::uint32_t number;
            object_index object;
        };
        std::size_t frames = 2;
        std::uint32_t width = 6;
        std::uint32_t speed = 2;
        std::uint32_t first_object = 0; ///< points below are of object 0, the others of object 1
        std::size_t frame_count() const { return frames; }
        grid_extents grid() const { return {1, width}; }
        std::optional<point_type> point_at(frame_index i, token_index t) const {
            auto const number = t.value + speed * i.value;
            return point_type{number, {number < first_object ? 0U : 1U}};
        }
        std::optional<token_index> token_at(frame_index i, point_type const& point) const {
            auto const first = speed * i.value;
            auto const is_seen = point.number >= first && point.number < first + width;
            return is_seen ? std::optional(token_index{point.number - first}) : std::nullopt;
        }
    };

    constexpr std::array<std::size_t, 1> next{1};

    TEST_CASE("paint that goes along has a ratio of 0") {
        stack<double, 4> images({2, 1, 1, 6});
        for (std::size_t p = 0; p < 6; ++p) {
            images(0, 0, 0, p) = static_cast<double>(p * p);
            images(1, 0, 0, p) = static_cast<double>((p + 2) * (p + 2));
        }
        auto const found = sticking(images.view(), moving_strip{}, next)[0];
        CHECK(found.pairs == 4);
        CHECK(found.along_surface == 0.0);
        CHECK(*found.ratio == 0.0);
        // At the places: (p + 2)^2 - p^2 = 4 p + 4 for p = 0 ... 3.
        CHECK(found.at_place == doctest::Approx(std::sqrt((16 + 64 + 144 + 256) / 4.0)));
    }

    TEST_CASE(
        "paint that stays on the screen changes nowhere at its place and has no ratio, nearly such paint a high one") {
        auto images = random_stack<double, 4>({2, 3, 1, 6}, 4);
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t p = 0; p < 6; ++p) {
                images(1, c, 0, p) = images(0, c, 0, p);
            }
        }
        CHECK_FALSE(sticking(images.view(), moving_strip{}, next)[0].ratio);
        CHECK(sticking(images.view(), moving_strip{}, next)[0].along_surface > 0);
        images(1, 0, 0, 1) += 1e-3;
        CHECK(*sticking(images.view(), moving_strip{}, next)[0].ratio > 100);
    }

    TEST_CASE("unrelated frames have a ratio of 1") {
        auto const images = random_stack<double, 4>({4, 3, 1, 3000}, 9);
        CHECK(*sticking(images.view(), moving_strip{4, 3000}, next)[0].ratio == doctest::Approx(1).epsilon(0.03));
    }

    TEST_CASE("pixels that do not move do not count") {
        auto const images = random_stack<float, 4>({3, 1, 1, 6}, 2);
        CHECK(sticking(images.view(), moving_strip{3, 6, 1}, next)[0].pairs == 0);
        CHECK_FALSE(sticking(images.view(), moving_strip{3, 6, 1}, next)[0].ratio);
        CHECK(sticking(images.view(), moving_strip{3, 6, 1}, std::array<std::size_t, 1>{2})[0].pairs == 4);
        CHECK(sticking(images.view(), moving_strip{3, 6, 1}, next, every_object{}, 1)[0].pairs == 10);
    }

    TEST_CASE(
        "places that another object fills in the earlier frame do not count, nor do objects that are not chosen") {
        auto const images = random_stack<float, 4>({2, 1, 1, 6}, 2);
        // Frame 0 shows points 0 ... 5, frame 1 points 2 ... 7; of places 0 ... 3, which correspond, 0 and 1 show points
        // 0 and 1 in frame 0, which are of another object than 2 and 3.
        CHECK(sticking(images.view(), moving_strip{2, 6, 2, 2}, next)[0].pairs == 2);
        auto const first = [](object_index object) { return object.value == 0; };
        CHECK(sticking(images.view(), moving_strip{2, 6, 2, 3}, next, first)[0].pairs == 1);
    }

    TEST_CASE("other extents, an interval of zero and no least motion are refused") {
        CHECK_THROWS_WITH_AS(sticking(stack<float, 4>({2, 3, 1, 5}).view(), moving_strip{}, next),
                             "sticking: images is [2, 3, 1, 5], expected [2, 3, 1, 6]", shape_error);
        stack<float, 4> const images({2, 3, 1, 6});
        CHECK_THROWS_WITH_AS(sticking(images.view(), moving_strip{}, std::array<std::size_t, 1>{0}),
                             "sticking: interval is 0, expected at least 1", value_error);
        CHECK_THROWS_WITH_AS(sticking(images.view(), moving_strip{}, next, every_object{}, 0),
                             "sticking: least_motion is 0.000000, expected above 0", value_error);
    }
}
