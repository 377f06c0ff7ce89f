// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Maps by feature resolution.
#include <genrender/correspondence/correspondence_set.hpp>

#include "../support/shifted_strip.hpp"

#include <doctest/doctest.h>

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
}
