// SPDX-License-Identifier: MIT
// The measures of a grid, on a surface that moves by a known way.
#include <genrender/inspection/grid_check.hpp>

#include <genrender/correspondence/footprint_map.hpp>
#include <genrender/maps/uv_maps.hpp>
#include <support/slanted_maps.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace grid_check_test {

using namespace genrender;

/// Measures of a map by frame 0's pairs with keyframe 1.
template <class Map>
grid_check measured(Map const& map, uv_maps_view const& view) {
    std::map<frame_index, screen_search<uv_maps_view>> searches;
    searches.emplace(frame_index{1}, screen_search(view, {1}));
    return check_grid(map, view, {{0}}, {{{1}}}, searches, 4096);
}

/// Finds the token at the same place of the screen in every frame, or the first token, or none.
struct fixed_answers {
    using point_type = token_index;
    std::optional<token_index> (*answer)(token_index);

    std::size_t frame_count() const { return 2; }
    grid_extents grid() const { return {16, 16}; }
    std::optional<point_type> point_at(frame_index, token_index t) const {
        auto const row = t.value / 16;
        auto const column = t.value % 16;
        return row >= 1 && row < 15 && column >= 1 && column < 15 ? std::optional(t) : std::nullopt;
    }
    std::optional<token_index> token_at(frame_index, point_type t) const { return answer(t); }
};

} // namespace grid_check_test

TEST_SUITE("inspection/grid_check") {
    using namespace genrender;
    using namespace grid_check_test;

    TEST_CASE("footprints find every partner near its place") {
        auto const maps = testing::slanted_maps(2);
        auto const view = to_uv_view(maps);
        auto const check = measured(footprint_map(view, {16, 16}), view);
        CHECK(check.grid == grid_extents{16, 16});
        CHECK(check.seen ==
              14 * 14); // the surface's left end at column 4 leaves by 1.5 pixels; its token's middle stays
        CHECK(check.hit_rate() == 1);
        // A representative lies half a pixel up and left of its token's middle and moves on to the left by 1.25 of 4.
        CHECK(*check.error() == doctest::Approx(std::hypot(1.75 / 4, 0.5 / 4)).epsilon(1e-3));
        CHECK(check.on_objects == 14 * 14);
    }

    TEST_CASE("staying where one was is an error of the way that the surface went") {
        auto const maps = testing::slanted_maps(2);
        auto const view = to_uv_view(maps);
        auto const check = measured(fixed_answers{[](token_index t) { return std::optional(t); }}, view);
        CHECK(check.hit_rate() == 1);
        CHECK(*check.error() == doctest::Approx(std::hypot(1.75 / 4, 0.5 / 4)).epsilon(1e-3));
        CHECK(check.collisions() == 0);
        CHECK(check.coverage() == 1);
    }

    TEST_CASE("tokens that all find one collide and those that find none are missed") {
        auto const maps = testing::slanted_maps(2);
        auto const view = to_uv_view(maps);
        auto const first = measured(fixed_answers{[](token_index) { return std::optional(token_index{0}); }}, view);
        CHECK(first.collisions() == 1);
        CHECK(first.found == 14 * 14);
        auto const none = measured(fixed_answers{[](token_index) { return std::optional<token_index>(); }}, view);
        CHECK(none.hit_rate() == 0);
        CHECK_FALSE(none.error());
        CHECK_FALSE(none.collisions());
        CHECK(none.coverage() == 0);
    }

    TEST_CASE("cover tells of every token in how many steps it is covered") {
        auto const maps = testing::slanted_maps(2);
        auto const view = to_uv_view(maps);
        auto const half =
            fixed_answers{[](token_index t) { return t.value % 16 < 8 ? std::optional(t) : std::nullopt; }};
        auto const check = measured(half, view);
        REQUIRE(check.cover.size() == 1);
        CHECK(check.cover[0].frame == frame_index{0});
        CHECK_FALSE(check.cover[0].steps[0]);
        CHECK(check.cover[0].steps[16 + 1] == std::size_t{1});
        CHECK(check.cover[0].steps[16 + 9] == std::size_t{0});
        CHECK(check.coverage() == 0.5);
    }

    TEST_CASE("a frame has no pairs with itself but covers itself") {
        auto const maps = testing::slanted_maps(2);
        auto const view = to_uv_view(maps);
        std::map<frame_index, screen_search<uv_maps_view>> searches;
        searches.emplace(frame_index{0}, screen_search(view, {0}));
        auto const check = check_grid(footprint_map(view, {16, 16}), view, {{0}}, {{{0}}}, searches);
        CHECK(check.seen == 0);
        CHECK_FALSE(check.hit_rate());
        CHECK(check.coverage() == 1);
    }

    TEST_CASE("no steps and no frames measure nothing") {
        auto const maps = testing::slanted_maps(2);
        auto const view = to_uv_view(maps);
        std::map<frame_index, screen_search<uv_maps_view>> const none;
        footprint_map const map(view, {16, 16});
        CHECK_FALSE(check_grid(map, view, {{0}}, {}, none).coverage());
        CHECK_FALSE(check_grid(map, view, {}, {}, none).hit_rate());
    }
}
