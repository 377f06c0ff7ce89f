// SPDX-License-Identifier: MIT
// UV maps in anybody's memory and in any layout.
#include <genrender/guidance/uv_maps_view.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <array>

TEST_SUITE("guidance/uv_maps_view") {
    using namespace genrender;

    TEST_CASE("extents come from coverage") {
        stack<float, 4> const uv({3, 4, 5, 2});
        stack<std::uint32_t, 3> const object({3, 4, 5});
        stack<std::uint8_t, 3> const coverage({3, 4, 5});
        uv_maps_view const view(uv.view(), object.view(), coverage.view());
        CHECK(view.frame_count() == 3);
        CHECK(view.grid() == grid_extents{4, 5});
    }

    TEST_CASE("planes of u and v are as good as pairs") {
        // [2 coordinates, 1 frame, 2 rows, 2 columns] in memory, seen as [frames, height, width, 2].
        std::array<float, 8> const planes{0, 1, 2, 3, 10, 11, 12, 13};
        strided_view<float const, 4> const uv(planes.data(), {1, 2, 2, 2}, {4, 2, 1, 4});
        stack<std::uint32_t, 3> object({1, 2, 2});
        stack<std::uint8_t, 3> coverage({1, 2, 2});
        coverage(0, 1, 0) = 255; // anything but 0 is covered
        object(0, 1, 0) = 4;
        uv_maps_view const view(uv, object.view(), coverage.view());
        CHECK(view.point_at({0}, {1, 0}) == std::array{2.0f, 12.0f});
        CHECK(view.is_covered({0}, {1, 0}));
        CHECK_FALSE(view.is_covered({0}, {0, 0}));
        CHECK(view.object_at({0}, {1, 0}) == object_index{4});
    }

    TEST_CASE("maps that do not fit each other are refused by name") {
        stack<float, 4> const uv({1, 2, 2, 2});
        stack<float, 4> const rgb({1, 2, 2, 3});
        stack<std::uint32_t, 3> const object({1, 2, 2});
        stack<std::uint8_t, 3> const coverage({1, 2, 2});
        stack<std::uint32_t, 3> const other({1, 2, 3});
        CHECK_NOTHROW(uv_maps_view(uv.view(), object.view(), coverage.view()));
        CHECK_THROWS_WITH_AS(uv_maps_view(rgb.view(), object.view(), coverage.view()),
                             "uv_maps_view: uv is [1, 2, 2, 3], expected [1, 2, 2, 2]", shape_error);
        CHECK_THROWS_WITH_AS(uv_maps_view(uv.view(), other.view(), coverage.view()),
                             "uv_maps_view: object is [1, 2, 3], expected [1, 2, 2]", shape_error);
    }
}
