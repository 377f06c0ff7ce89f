// SPDX-License-Identifier: MIT
// Tests of the map with spare memory.
#include <genrender/reference/spare_map.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <utility>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/spare_map") {
    /// Feature c of token t is 10 t + c.
    spare_map<float> counted(grid_extents grid, std::size_t channels) {
        spare_map<float> map(grid, channels);
        for (std::size_t t = 0; t < grid.size(); ++t) {
            for (std::size_t c = 0; c < channels; ++c) {
                map.view()(t, c) = static_cast<float>(10 * t + c);
            }
        }
        return map;
    }

    TEST_CASE("channels that are kept move to the front and leave spare memory") {
        auto map = counted({2, 3}, 5);
        CHECK(map.spare_size() == 0);
        map.keep_channels(2, 2);
        CHECK(map.channels() == 2);
        CHECK(map.grid() == grid_extents{2, 3});
        CHECK(map.size() == 12);
        CHECK(map.spare_size() == 18);
        for (std::size_t t = 0; t < 6; ++t) {
            CHECK(std::as_const(map).view()(t, 0) == static_cast<float>(10 * t + 2));
            CHECK(std::as_const(map).view()(t, 1) == static_cast<float>(10 * t + 3));
        }
    }

    TEST_CASE("scratch lies behind the map if it fits there") {
        auto map = counted({2, 3}, 5);
        stack<float, 1> storage;
        auto const elsewhere = map.scratch(storage);
        CHECK(elsewhere.extents() == std::array<std::size_t, 2>{6, 5});
        CHECK(elsewhere.data() == storage.data());
        map.keep_channels(0, 2);
        auto const behind = map.scratch(storage);
        CHECK(behind.data() == map.view().data() + 12);
        CHECK(behind.extents() == std::array<std::size_t, 2>{6, 2});
        map.keep_channels(0, 1);
        CHECK(map.scratch(storage).data() == map.view().data() + 6);
    }

    TEST_CASE("trimming gives the spare memory back and keeps the features") {
        auto map = counted({2, 2}, 4);
        map.keep_channels(1, 3);
        map.trim();
        CHECK(map.spare_size() == 0);
        for (std::size_t t = 0; t < 4; ++t) {
            for (std::size_t c = 0; c < 3; ++c) {
                CHECK(map.view()(t, c) == static_cast<float>(10 * t + c + 1));
            }
        }
    }
}
