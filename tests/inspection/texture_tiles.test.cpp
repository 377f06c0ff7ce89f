// SPDX-License-Identifier: MIT
// Only places that two tiles use are repeated.
#include <genrender/inspection/texture_tiles.hpp>

#include <doctest/doctest.h>

TEST_SUITE("inspection/texture_tiles") {
    using namespace genrender;

    TEST_CASE("pixels count where their square is used a whole tile apart") {
        texture_tiles tiles;
        tiles.add({0.1F, 0.1F});
        tiles.add({1.1F, 0.1F});  // the same place of the next tile
        tiles.add({-0.9F, 0.1F}); // and of the one before
        tiles.add({1.5F, 0.1F});  // a place that only this tile uses
        tiles.add({1.5F, 0.1F});
        CHECK(tiles.repeated() == 3);
    }

    TEST_CASE("both borders belong to the texture") {
        texture_tiles tiles;
        tiles.add({0, 0});
        tiles.add({1, 0});
        tiles.add({0, 1});
        tiles.add({1, 1});
        CHECK(tiles.repeated() == 0);
    }

    TEST_CASE("what several frames use is added up") {
        texture_tiles all;
        texture_tiles first;
        texture_tiles second;
        first.add({0.3F, 0.3F});
        second.add({0.3F, 2.3F});
        all.add(first);
        CHECK(all.repeated() == 0);
        all.add(second);
        CHECK(all.repeated() == 2);
        CHECK(texture_tiles().repeated() == 0);
    }

    TEST_CASE("tiles beyond what floats tell apart are tiles too") {
        texture_tiles tiles;
        tiles.add({3.0e38F, -3.0e38F});
        tiles.add({0, 0});
        CHECK(tiles.repeated() == 2);
    }
}
