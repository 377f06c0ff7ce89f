// SPDX-License-Identifier: MIT
// Pixels whose coordinates are not finite are background; all others stay what they are.
#include <genrender/inspection/finite_maps.hpp>

#include <genrender/maps/uv_maps.hpp>

#include <doctest/doctest.h>

#include <array>
#include <limits>

TEST_SUITE("inspection/finite_maps") {
    using namespace genrender;
    static_assert(canonical_maps<finite_maps<uv_maps_view>>);
    static_assert(finite_maps<position_maps_view>::dimensions == 3);

    TEST_CASE("a point is finite if all its coordinates are") {
        CHECK(is_finite(std::array{0.0F, -3.0e38F}));
        CHECK_FALSE(is_finite(std::array{0.0F, std::numeric_limits<float>::quiet_NaN()}));
        CHECK_FALSE(is_finite(std::array{-std::numeric_limits<float>::infinity(), 0.0F}));
    }

    TEST_CASE("what is not finite is background") {
        uv_maps maps(1, {1, 3});
        maps.coverage(0, 0, 0) = maps.coverage(0, 0, 1) = 1;
        maps.object(0, 0, 0) = 5;
        maps.uv(0, 0, 0, 1) = 0.5F;
        maps.uv(0, 0, 1, 0) = std::numeric_limits<float>::infinity();
        auto const all = to_uv_view(maps);
        finite_maps const finite(all);
        CHECK(finite.frame_count() == 1);
        CHECK(finite.grid() == grid_extents{1, 3});
        CHECK(finite.is_covered({0}, {0, 0}));
        CHECK(finite.object_at({0}, {0, 0}) == object_index{5});
        CHECK(finite.point_at({0}, {0, 0}) == std::array{0.0F, 0.5F});
        CHECK_FALSE(finite.is_covered({0}, {0, 1}));
        CHECK_FALSE(finite.is_covered({0}, {0, 2}));
    }
}
