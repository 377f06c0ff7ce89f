// SPDX-License-Identifier: MIT
// [GR sec. 3] The concept accepts what names surface points and nothing else; rest positions in any layout.
#include <genrender/maps/canonical_maps.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/maps/uv_maps_view.hpp>

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

struct maps_of_one_dimension : maps_of_another_dimension {
    static constexpr std::size_t dimensions = 1;
    std::array<float, 1> point_at(frame_index, pixel) const;
};

static_assert(!canonical_maps<maps_of_one_dimension>);
static_assert(canonical_maps<uv_maps_view>);
static_assert(canonical_maps<position_maps_view>);
static_assert(uv_maps_view::dimensions == 2);
static_assert(position_maps_view::dimensions == 3);
static_assert(maps_without_objects::dimensions == 2 && !canonical_maps<maps_without_objects>);
static_assert(!canonical_maps<maps_of_another_dimension>);
static_assert(!canonical_maps<int>);

} // namespace

TEST_SUITE("maps/canonical_maps") {
    TEST_CASE_TEMPLATE("extents come from coverage", Maps, uv_maps_view, position_maps_view) {
        stack<float, 4> const points({3, 4, 5, Maps::dimensions});
        stack<std::uint32_t, 3> const object({3, 4, 5});
        stack<std::uint8_t, 3> const coverage({3, 4, 5});
        Maps const view(points.view(), object.view(), coverage.view());
        CHECK(view.frame_count() == 3);
        CHECK(view.grid() == grid_extents{4, 5});
    }

    TEST_CASE_TEMPLATE("planes of coordinates are as good as points", Maps, uv_maps_view, position_maps_view) {
        // [coordinates, 1 frame, 2 rows, 2 columns] in memory, seen as [frames, height, width, coordinates].
        std::array<float, 12> const planes{0, 1, 2, 3, 10, 11, 12, 13, 20, 21, 22, 23};
        strided_view<float const, 4> const points(planes.data(), {1, 2, 2, Maps::dimensions}, {4, 2, 1, 4});
        stack<std::uint32_t, 3> object({1, 2, 2});
        stack<std::uint8_t, 3> coverage({1, 2, 2});
        coverage(0, 1, 0) = 255; // anything but 0 is covered
        object(0, 1, 0) = 4;
        Maps const view(points, object.view(), coverage.view());
        auto const point = view.point_at({0}, {1, 0});
        for (std::size_t d = 0; d < Maps::dimensions; ++d) {
            CHECK(point[d] == 10 * static_cast<float>(d) + 2);
        }
        CHECK(view.is_covered({0}, {1, 0}));
        CHECK_FALSE(view.is_covered({0}, {0, 0}));
        CHECK(view.object_at({0}, {1, 0}) == object_index{4});
    }

    TEST_CASE("maps that do not fit each other are refused by name") {
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
