// SPDX-License-Identifier: MIT
// Shares of cells in pictures.
#include <genrender/maps/cell_shares.hpp>

#include "../support/small_maps.hpp"

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("maps/cell_shares") {
    TEST_CASE("a cell's share is that of the object with most of its pixels") {
        auto const maps = testing::drawn_maps({"aaab.... aabb...a", "........ ........"});
        auto const shares = cell_shares(to_uv_view(maps), {1, 4});
        CHECK(shares(0, 0, 0) == 255);
        CHECK(shares(0, 0, 1) == 191); // three of four
        CHECK(shares(0, 0, 2) == 0);
        CHECK(shares(0, 0, 3) == 64); // one of four
        for (std::size_t column = 0; column < 4; ++column) {
            CHECK(shares(1, 0, column) == 0);
        }
    }
    TEST_CASE("the background of a cell counts against its object") {
        auto const maps = testing::drawn_maps({"ab.. .b.."});
        CHECK(cell_shares(to_uv_view(maps), {1, 2})(0, 0, 0) == 128); // two of four
        CHECK(cell_shares(to_uv_view(maps), {2, 4})(0, 0, 0) == 255);
    }
    TEST_CASE("a grid that does not divide the maps is refused") {
        auto const maps = testing::drawn_maps({"aaa"});
        CHECK_THROWS_WITH_AS(cell_shares(to_uv_view(maps), {1, 2}),
                             "cell_shares: grid is [1, 2], expected extents that divide the maps' [1, 3]", value_error);
    }
}
