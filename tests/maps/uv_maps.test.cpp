// SPDX-License-Identifier: MIT
// UV maps begin empty and are read through their view.
#include <genrender/maps/uv_maps.hpp>

#include <doctest/doctest.h>

TEST_SUITE("maps/uv_maps") {
    using namespace genrender;

    TEST_CASE("new maps show nothing") {
        uv_maps const maps(3, {4, 5});
        CHECK(maps.frame_count() == 3);
        CHECK(maps.grid() == grid_extents{4, 5});
        CHECK(maps.uv.size() == 3 * 4 * 5 * 2);
        for (auto const covered : maps.coverage) {
            REQUIRE(covered == 0);
        }
        for (auto const value : maps.uv) {
            REQUIRE(value == 0);
        }
    }

    TEST_CASE("the view reads the maps' own memory") {
        uv_maps maps(2, {2, 3});
        auto const view = to_uv_view(maps);
        maps.coverage(1, 0, 2) = 1;
        maps.object(1, 0, 2) = 7;
        maps.uv(1, 0, 2, 0) = 0.25f;
        maps.uv(1, 0, 2, 1) = 0.5f;
        CHECK(view.is_covered({1}, {0, 2}));
        CHECK(view.object_at({1}, {0, 2}) == object_index{7});
        CHECK(view.point_at({1}, {0, 2}) == std::array{0.25f, 0.5f});
        CHECK_FALSE(view.is_covered({0}, {0, 2}));
    }

    TEST_CASE("maps of different extents have no view") {
        uv_maps maps(2, {2, 3});
        maps.object = tensor<std::uint32_t, 3>::from_shape({2, 3, 3});
        CHECK_THROWS_WITH_AS(to_uv_view(maps), "uv_maps_view: object is [2, 3, 3], expected [2, 2, 3]", shape_error);
    }
}
