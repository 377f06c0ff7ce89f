// SPDX-License-Identifier: MIT
// [GR sec. 3] Cells of map pixels.
#include <genrender/maps/cell_extents.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("maps/cell_extents") {
    TEST_CASE("a cell is the whole ratio of the extents") {
        CHECK(cell_extents("here", {512, 256}, {64, 64}) == grid_extents{8, 4});
        CHECK(cell_extents("here", {3, 3}, {3, 1}) == grid_extents{1, 3});
    }
    TEST_CASE("extents that do not divide are refused in the caller's name") {
        CHECK_THROWS_WITH_AS(cell_extents("here", {512, 256}, {64, 60}),
                             "here: grid is [64, 60], expected extents that divide the maps' [512, 256]", value_error);
        CHECK_THROWS_AS(cell_extents("here", {512, 256}, {0, 64}), value_error);
        CHECK_THROWS_AS(cell_extents("here", {0, 256}, {1, 64}), value_error);
    }
}
