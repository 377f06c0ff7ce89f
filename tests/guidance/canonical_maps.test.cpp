// SPDX-License-Identifier: MIT
// [GR sec. 3] The concept accepts what names surface points and nothing else; rest positions in any layout.
#include <genrender/guidance/canonical_maps.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/guidance/uv_maps_view.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>

using namespace genrender;

namespace {

struct maps_without_objects {
    static constexpr std::size_t dimensions = 2;
    std::size_t frame_count() const;
    grid_extents grid() const;
    bool is_covered(frame_index, pixel) const;
    std::array<float, 2> point_at(frame_index, pixel) const;
};

struct maps_of_another_dimension {
    static constexpr std::size_t dimensions = 3;
    std::size_t frame_count() const;
    grid_extents grid() const;
    bool is_covered(frame_index, pixel) const;
    object_index object_at(frame_index, pixel) const;
    std::array<float, 2> point_at(frame_index, pixel) const; // two coordinates where three are promised
};

static_assert(canonical_maps<uv_maps_view>);
static_assert(canonical_maps<position_maps_view>);
static_assert(uv_maps_view::dimensions == 2);
static_assert(position_maps_view::dimensions == 3);
static_assert(maps_without_objects::dimensions == 2 && !canonical_maps<maps_without_objects>);
static_assert(!canonical_maps<maps_of_another_dimension>);
static_assert(!canonical_maps<int>);

} // namespace

TEST_SUITE("guidance/canonical_maps") {
    TEST_CASE("[GR sec. 3] the canonical point of UV maps is the texture coordinate") {
        stack<float, 4> uv({1, 1, 2, 2});
        uv(0, 0, 1, 0) = 0.25F;
        uv(0, 0, 1, 1) = 0.75F;
        stack<std::uint32_t, 3> const object({1, 1, 2});
        stack<std::uint8_t, 3> const coverage({1, 1, 2});
        uv_maps_view const view(uv.view(), object.view(), coverage.view());
        CHECK(view.point_at({0}, {0, 1}) == std::array{0.25F, 0.75F});
    }

    TEST_CASE("extents of position maps come from coverage") {
        stack<float, 4> const position({3, 4, 5, 3});
        stack<std::uint32_t, 3> const object({3, 4, 5});
        stack<std::uint8_t, 3> const coverage({3, 4, 5});
        position_maps_view const view(position.view(), object.view(), coverage.view());
        CHECK(view.frame_count() == 3);
        CHECK(view.grid() == grid_extents{4, 5});
    }

    TEST_CASE("planes of x and y and z are as good as triples") {
        // [3 coordinates, 1 frame, 2 rows, 2 columns] in memory, seen as [frames, height, width, 3].
        std::array<float, 12> const planes{0, 1, 2, 3, 10, 11, 12, 13, 20, 21, 22, 23};
        strided_view<float const, 4> const position(planes.data(), {1, 2, 2, 3}, {4, 2, 1, 4});
        stack<std::uint32_t, 3> object({1, 2, 2});
        stack<std::uint8_t, 3> coverage({1, 2, 2});
        coverage(0, 1, 0) = 255; // anything but 0 is covered
        object(0, 1, 0) = 4;
        position_maps_view const view(position, object.view(), coverage.view());
        CHECK(view.point_at({0}, {1, 0}) == std::array{2.0F, 12.0F, 22.0F});
        CHECK(view.is_covered({0}, {1, 0}));
        CHECK_FALSE(view.is_covered({0}, {0, 0}));
        CHECK(view.object_at({0}, {1, 0}) == object_index{4});
    }

    TEST_CASE("position maps that do not fit each other are refused by name") {
        stack<float, 4> const position({1, 2, 2, 3});
        stack<float, 4> const uv({1, 2, 2, 2});
        stack<float, 4> const longer({2, 2, 2, 3});
        stack<std::uint32_t, 3> const object({1, 2, 2});
        stack<std::uint32_t, 3> const wider({1, 2, 3});
        stack<std::uint8_t, 3> const coverage({1, 2, 2});
        CHECK_NOTHROW(position_maps_view(position.view(), object.view(), coverage.view()));
        CHECK_THROWS_WITH_AS(position_maps_view(uv.view(), object.view(), coverage.view()),
                             "position_maps_view: position is [1, 2, 2, 2], expected [1, 2, 2, 3]", shape_error);
        CHECK_THROWS_WITH_AS(position_maps_view(longer.view(), object.view(), coverage.view()),
                             "position_maps_view: position is [2, 2, 2, 3], expected [1, 2, 2, 3]", shape_error);
        CHECK_THROWS_WITH_AS(position_maps_view(position.view(), wider.view(), coverage.view()),
                             "position_maps_view: object is [1, 2, 3], expected [1, 2, 2]", shape_error);
    }
}
