// SPDX-License-Identifier: MIT
// [GR sec. 4] Images painted from a texture agree everywhere; what is added to them is what the error says.
#include <genrender/evaluation/correspondence_error.hpp>

#include <genrender/core/stack.hpp>
#include <genrender/correspondence/texel_grid.hpp>
#include <genrender/evaluation/pixel_correspondence.hpp>

#include <doctest/doctest.h>

#include "support/random_scene.hpp"
#include <genrender/testing/random_stack.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

using namespace genrender;
using genrender::testing::random_scene;
using genrender::testing::random_stack;

namespace {

static_assert(point_of_object<texel>);
static_assert(!point_of_object<std::uint32_t>);

/// A strip of points that slides by one pixel a frame under a window of four: pixel p of frame i shows point p + i, and
/// point 3 is hidden in frame 1.
struct sliding_strip {
    using point_type = std::uint32_t;
    std::size_t frames = 3;
    std::size_t frame_count() const { return frames; }
    grid_extents grid() const { return {1, 4}; }
    std::optional<point_type> point_at(frame_index i, token_index t) const {
        auto const point = t.value + i.value;
        return i.value == 1 && point == 3 ? std::nullopt : std::optional(point);
    }
    std::optional<token_index> token_at(frame_index i, point_type point) const {
        auto const is_seen = point >= i.value && point < i.value + 4 && !(i.value == 1 && point == 3);
        return is_seen ? std::optional(token_index{point - i.value}) : std::nullopt;
    }
};

/// Nothing corresponds, since every frame is background.
struct nothing_there : sliding_strip {
    std::optional<point_type> point_at(frame_index, token_index) const { return std::nullopt; }
};

/// Images [frames, channels, 1, 4] whose pixels hold 10 c + the number of the point they show.
stack<double, 4> painted(sliding_strip const& map, std::size_t channels) {
    stack<double, 4> images({map.frames, channels, 1, 4});
    for (std::size_t i = 0; i < map.frames; ++i) {
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t p = 0; p < 4; ++p) {
                images(i, c, 0, p) = static_cast<double>(10 * c + p + i);
            }
        }
    }
    return images;
}

/// Images whose pixels hold a random value of the texel they read; the background holds NaN.
template <class Real>
stack<Real, 4> painted(texel_grid const& map, std::size_t channels) {
    auto const grid = map.grid();
    auto const texture = random_stack<Real, 2>({map.slot_count(), channels}, 5);
    stack<Real, 4> images({map.frame_count(), channels, grid.height, grid.width});
    for (std::uint32_t i = 0; i < map.frame_count(); ++i) {
        for (std::uint32_t t = 0; t < grid.size(); ++t) {
            auto const point = map.point_at({i}, {t});
            for (std::size_t c = 0; c < channels; ++c) {
                images(i, c, t / grid.width, t % grid.width) =
                    point ? texture(point->slot, c) : std::numeric_limits<Real>::quiet_NaN();
            }
        }
    }
    return images;
}

/// Images of `grid` of one smooth texture, an average over the map pixels under each pixel; object 1 is brighter in
/// odd frames by `blink`.
template <class Real>
stack<Real, 4> rendered(uv_maps_view const& maps, grid_extents grid, double blink) {
    stack<Real, 4> images({maps.frame_count(), 1, grid.height, grid.width});
    auto const cell = maps.grid().height / grid.height;
    for (std::uint32_t i = 0; i < maps.frame_count(); ++i) {
        for (std::uint32_t row = 0; row < maps.grid().height; ++row) {
            for (std::uint32_t column = 0; column < maps.grid().width; ++column) {
                auto const uv = maps.point_at({i}, {row, column});
                auto const is_bright = i % 2 == 1 && maps.object_at({i}, {row, column}).value == 1;
                auto const colour =
                    std::sin(12 * std::numbers::pi * double{uv[0]}) * std::sin(12 * std::numbers::pi * double{uv[1]}) +
                    (is_bright ? blink : 0.0);
                images(i, 0, row / cell, column / cell) +=
                    static_cast<Real>(maps.is_covered({i}, {row, column}) ? colour : 0.0) /
                    static_cast<Real>(cell * cell);
            }
        }
    }
    return images;
}

} // namespace

TEST_SUITE("evaluation/correspondence_error") {
    TEST_CASE("[GR sec. 4] images painted from one strip agree") {
        sliding_strip const map;
        CHECK(correspondence_map<sliding_strip>);
        auto const images = painted(map, 2);
        CHECK(correspondence_error(images.view(), map, 1) == 0.0);
        CHECK(correspondence_error(images.view(), map, 2) == 0.0);
    }

    TEST_CASE_TEMPLATE("[GR sec. 4] images painted from a texture agree at every interval", Real, float, double) {
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            auto const maps = random_scene(seed, 4, {24, 24}, 3);
            texel_grid const map(to_uv_view(maps), {24, 24});
            auto const images = painted<Real>(map, 3);
            for (std::size_t interval = 1; interval < 4; ++interval) {
                CAPTURE(interval);
                CHECK(correspondence_error(images.view(), map, interval) == 0.0);
            }
        }
    }

    TEST_CASE("[GR sec. 4] a known offset of a frame is the error") {
        sliding_strip const map;
        auto images = painted(map, 2);
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t e = 0; e < 8; ++e) {
                images.data()[8 * i + e] += 0.25 * static_cast<double>(i);
            }
        }
        CHECK(*correspondence_error(images.view(), map, 1) == doctest::Approx(0.25));
        CHECK(*correspondence_error(images.view(), map, 2) == doctest::Approx(0.5));
    }

    TEST_CASE("[GR sec. 4] it is the root of the mean square over pairs and channels by hand") {
        // Frames 0 and 1 share points 1 and 2 (3 is hidden in frame 1), frames 1 and 2 share 2 and 4:
        // four pairs of two channels.
        sliding_strip const map;
        auto images = painted(map, 2);
        images(0, 1, 0, 1) += 3; // point 1, once in a pair
        images(1, 0, 0, 1) -= 4; // point 2 in frame 1, in two pairs
        CHECK(*correspondence_error(images.view(), map, 1) == doctest::Approx(std::sqrt((9 + 16 + 16) / 8.0)));
        // Frames 0 and 2 share points 2 and 3: neither change is among them.
        CHECK(*correspondence_error(images.view(), map, 2) == 0.0);
    }

    TEST_CASE("[GR sec. 4] hidden points and points out of view do not count") {
        sliding_strip const map;
        auto images = painted(map, 1);
        auto const NaN = std::numeric_limits<double>::quiet_NaN();
        images(0, 0, 0, 0) = NaN; // point 0 leaves the view
        images(1, 0, 0, 2) = NaN; // point 3 is hidden in frame 1
        images(2, 0, 0, 3) = NaN; // point 5 has just come into view
        CHECK(correspondence_error(images.view(), map, 1) == 0.0);
        CHECK(correspondence_error(images.view(), map, 2) == 0.0);
    }

    TEST_CASE("[GR sec. 4] nothing that corresponds is no error and not 0") {
        auto const images = painted(sliding_strip{}, 1);
        CHECK_FALSE(correspondence_error(images.view(), nothing_there{}, 1).has_value());
        stack<double, 4> const without_channels({3, 0, 1, 4});
        CHECK_FALSE(correspondence_error(without_channels.view(), sliding_strip{}, 1).has_value());
    }

    TEST_CASE("[GR sec. 4] an interval as long as the animation has no pair") {
        sliding_strip const map;
        auto const images = painted(map, 1);
        CHECK_FALSE(correspondence_error(images.view(), map, 3).has_value());
        CHECK_FALSE(correspondence_error(images.view(), map, std::numeric_limits<std::size_t>::max()).has_value());
        sliding_strip const one{1};
        CHECK_FALSE(correspondence_error(painted(one, 1).view(), one, 1).has_value());
    }

    TEST_CASE("independent noise of variance 1 has the error of two of them") {
        auto const maps = random_scene(2, 3, {32, 32}, 3);
        texel_grid const map(to_uv_view(maps), {32, 32});
        auto const images = random_stack<double, 4>({3, 8, 32, 32}, 9);
        CHECK(*correspondence_error(images.view(), map, 1) == doctest::Approx(std::sqrt(2.0)).epsilon(0.05));
    }

    TEST_CASE("[GR sec. 4] several intervals come with the number of their pairs") {
        sliding_strip const map;
        auto const images = painted(map, 2);
        auto const found = correspondence_errors(images.view(), map, std::array<std::size_t, 3>{2, 1, 3});
        REQUIRE(found.size() == 3);
        CHECK(found[0].interval == 2);
        CHECK(found[0].pairs == 2);
        CHECK(found[0].error == 0.0);
        CHECK(found[1].pairs == 4);
        CHECK(found[2].pairs == 0);
        CHECK_FALSE(found[2].error.has_value());
    }

    TEST_CASE_TEMPLATE("[GR sec. 4] chosen objects alone", Real, float, double) {
        auto const maps = random_scene(3, 4, {96, 96}, 3);
        pixel_correspondence const map(to_uv_view(maps), {48, 48});
        stack<Real, 4> images({4, 1, 48, 48});
        for (std::uint32_t i = 0; i < 4; ++i) {
            for (std::uint32_t p = 0; p < 48 * 48; ++p) {
                auto const point = map.point_at({i}, {p});
                images(i, 0, p / 48, p % 48) = static_cast<Real>(point && point->object.value == 1 ? 0.5 * i : 0.0);
            }
        }
        constexpr std::array<std::size_t, 2> intervals{1, 2};
        auto const all = correspondence_errors(images.view(), map, intervals);
        auto const blinking =
            correspondence_errors(images.view(), map, intervals, [](object_index o) { return o.value == 1; });
        auto const others =
            correspondence_errors(images.view(), map, intervals, [](object_index o) { return o.value != 1; });
        for (std::size_t k = 0; k < 2; ++k) {
            REQUIRE(blinking[k].pairs > 10);
            CHECK(*blinking[k].error == doctest::Approx(0.5 * static_cast<double>(intervals[k])));
            CHECK(*others[k].error == 0.0);
            CHECK(all[k].pairs == blinking[k].pairs + others[k].pairs);
            CHECK(*all[k].error ==
                  doctest::Approx(*blinking[k].error * std::sqrt(static_cast<double>(blinking[k].pairs) /
                                                                 static_cast<double>(all[k].pairs))));
        }
    }

    TEST_CASE_TEMPLATE("[GR sec. 4] renders of a texture differ less where pairs are closer", Real, float, double) {
        // The error of two perfect renders is the metric's own: the slope of the texture times the distance of pairs.
        auto const maps = random_scene(0, 5, {128, 128}, 3);
        auto const images = rendered<Real>(to_uv_view(maps), {32, 32}, 0);
        auto const error = [&](auto const& map) { return *correspondence_error(images.view(), map, 2); };
        auto const texels = error(texel_grid(to_uv_view(maps), {32, 32}));
        auto const wide = error(pixel_correspondence(to_uv_view(maps), {32, 32}, 0.5));
        auto const close = error(pixel_correspondence(to_uv_view(maps), {32, 32}, 0.25));
        auto const closest = error(pixel_correspondence(to_uv_view(maps), {32, 32}, 0.1));
        MESSAGE("texel_grid " << texels << ", reach 0.5: " << wide << ", 0.25: " << close << ", 0.1: " << closest);
        CHECK(wide < texels);
        CHECK(close < 0.7 * wide);
        CHECK(closest < 0.7 * close);
    }

    TEST_CASE("images of any strides are measured alike") {
        sliding_strip const map;
        auto const images = random_stack<double, 4>({3, 2, 1, 4}, 3);
        stack<double, 4> last({3, 1, 4, 2});
        strided_view<double, 4> const view(last.data(), {3, 2, 1, 4}, {8, 1, 8, 2});
        copy(view, images);
        CHECK(correspondence_error(view, map, 1) == correspondence_error(images.view(), map, 1));
    }

    TEST_CASE("shapes and intervals that do not fit are refused with a sentence") {
        sliding_strip const map;
        stack<float, 4> const short_one({2, 1, 1, 4});
        stack<float, 4> const wide({3, 1, 4, 1});
        stack<float, 4> const good({3, 1, 1, 4});
        CHECK_THROWS_WITH_AS(correspondence_error(short_one.view(), map, 1),
                             "correspondence_error: images is [2, 1, 1, 4], expected [3, 1, 1, 4]", shape_error);
        CHECK_THROWS_WITH_AS(correspondence_error(wide.view(), map, 1),
                             "correspondence_error: images is [3, 1, 4, 1], expected [3, 1, 1, 4]", shape_error);
        CHECK_THROWS_WITH_AS(correspondence_error(good.view(), map, 0),
                             "correspondence_error: interval is 0, expected at least 1", value_error);
    }
}
