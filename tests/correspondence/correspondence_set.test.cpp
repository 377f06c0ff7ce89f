// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Maps by feature resolution.
#include <genrender/correspondence/correspondence_set.hpp>

#include "../support/shifted_strip.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

using namespace genrender;

TEST_SUITE("correspondence/correspondence_set") {
    TEST_CASE("a map is made once per grid and found by it") {
        correspondence_set<testing::shifted_strip> maps;
        std::size_t made = 0;
        auto const make = [&](grid_extents grid) {
            ++made;
            return testing::shifted_strip{2, grid.width};
        };
        maps.add({1, 4}, make);
        maps.add({1, 4}, make);
        maps.add({1, 8}, make);
        CHECK(made == 2);
        CHECK(maps.at({1, 8}).width == 8);
        CHECK_THROWS_WITH_AS(maps.at({2, 2}), "correspondence_set: grid is [2, 2], expected one of the 2 grids added",
                             value_error);
    }
    TEST_CASE("the map of the latents is found and not listed unless features have its grid") {
        correspondence_set<testing::shifted_strip> maps;
        std::size_t made = 0;
        auto const make = [&](grid_extents grid) {
            ++made;
            return testing::shifted_strip{2, grid.width};
        };
        auto const listed = [&] {
            std::vector<std::size_t> widths;
            for (auto const& [grid, map] : maps) {
                widths.push_back(map.width);
            }
            return widths;
        };
        maps.add({1, 4}, make);
        maps.add_unlisted({1, 8}, make);
        maps.add_unlisted({1, 8}, make);
        maps.add_unlisted({1, 4}, make);
        CHECK(made == 2);
        CHECK(listed() == std::vector<std::size_t>{4});
        CHECK(maps.at({1, 8}).width == 8);
        CHECK(maps.at({1, 4}).width == 4);
        CHECK(maps.tokens_on_objects({1, 8}, {1}) == 8);
        maps.add({1, 8}, make);
        CHECK(made == 2);
        CHECK(listed() == std::vector<std::size_t>{4, 8});
        CHECK(maps.at({1, 8}).width == 8);
        CHECK(maps.tokens_on_objects({1, 8}, {1}) == 8);
    }
    TEST_CASE("the tokens of a frame that show an object are counted once") {
        struct counting_strip : testing::shifted_strip {
            std::size_t* asked = nullptr;
            std::optional<point_type> point_at(frame_index i, token_index t) const {
                ++*asked;
                return t.value < i.value ? std::nullopt : testing::shifted_strip::point_at(i, t);
            }
        };
        std::size_t asked = 0;
        correspondence_set<counting_strip> maps;
        maps.add({1, 4}, [&](grid_extents grid) { return counting_strip{{3, grid.width}, &asked}; });
        CHECK(asked == 3 * 4);
        CHECK(maps.tokens_on_objects({1, 4}, {0}) == 4);
        CHECK(maps.tokens_on_objects({1, 4}, {2}) == 2);
        CHECK(asked == 3 * 4);
        CHECK_THROWS_WITH_AS(maps.tokens_on_objects({1, 4}, {3}),
                             "correspondence_set: i is 3, expected a frame of the map", value_error);
        CHECK_THROWS_AS(maps.tokens_on_objects({1, 5}, {0}), value_error);
    }
}
