// SPDX-License-Identifier: MIT
// Pixels that one object fills, those that nothing touches, and the mixtures that are neither.
#include <genrender/evaluation/pixel_objects.hpp>

#include <doctest/doctest.h>

#include "support/small_maps.hpp"

#include <cstdint>
#include <optional>

using namespace genrender;
using genrender::testing::drawn_maps;

TEST_SUITE("evaluation/pixel_objects") {
    TEST_CASE("a pixel of 2 x 2 map pixels belongs to what fills it") {
        auto const maps = drawn_maps({"aabb..ab aabb..ab", "..a.bb.b ...abb.b"});
        pixel_objects const objects(to_uv_view(maps), {1, 4});
        CHECK(objects.frame_count() == 2);
        CHECK(objects.grid() == grid_extents{1, 4});
        auto const object_at = [&](std::uint32_t i, std::uint32_t column) {
            return objects.object_at({i}, {0, column});
        };
        CHECK(object_at(0, 0) == object_index{0});
        CHECK(object_at(0, 1) == object_index{1});
        CHECK(object_at(0, 2) == std::nullopt);
        CHECK(objects.is_background({0}, {0, 2}));
        // Two objects share the last pixel, object and background those of the other frame.
        CHECK(object_at(0, 3) == std::nullopt);
        CHECK_FALSE(objects.is_background({0}, {0, 3}));
        CHECK(objects.is_background({1}, {0, 0}));
        CHECK(object_at(1, 1) == std::nullopt);
        CHECK_FALSE(objects.is_background({1}, {0, 1}));
        CHECK(object_at(1, 2) == object_index{1});
        CHECK(object_at(1, 3) == std::nullopt);
        CHECK_FALSE(objects.is_background({1}, {0, 3}));
    }

    TEST_CASE("maps as large as the image have no silhouettes") {
        auto const maps = drawn_maps({"ab. .ba"});
        pixel_objects const objects(to_uv_view(maps), {2, 3});
        for (std::uint32_t row = 0; row < 2; ++row) {
            for (std::uint32_t column = 0; column < 3; ++column) {
                CHECK(objects.object_at({0}, {row, column}).has_value() != objects.is_background({0}, {row, column}));
            }
        }
        CHECK(objects.object_at({0}, {1, 2}) == object_index{0});
    }

    TEST_CASE("every object counts unless a metric is told otherwise") {
        CHECK(every_object{}({7}));
        CHECK(object_predicate<every_object>);
    }

    TEST_CASE("images of other extents are refused with a sentence") {
        auto const maps = drawn_maps({"aabb aabb"});
        CHECK_THROWS_WITH_AS(pixel_objects(to_uv_view(maps), {2, 3}),
                             "pixel_objects: grid is [2, 3], expected extents that divide the maps' [2, 4]",
                             value_error);
        pixel_objects const objects(to_uv_view(maps), {1, 2});
        CHECK_THROWS_WITH_AS(require_images_of("contrast", strided_view<float, 4>(nullptr, {2, 3, 1, 2}), objects),
                             "contrast: images is [2, 3, 1, 2], expected [1, 3, 1, 2]", shape_error);
    }
}
