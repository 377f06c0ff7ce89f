// SPDX-License-Identifier: MIT
// Gradients of ramps and steps by hand.
#include <genrender/evaluation/sharpness.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include "support/small_maps.hpp"

#include <cmath>

using namespace genrender;
using genrender::testing::drawn_maps;

TEST_SUITE("evaluation/sharpness") {
    TEST_CASE_TEMPLATE("a ramp is as steep as it is everywhere", Real, float, double) {
        auto const maps = drawn_maps({"aaaa aaaa aaaa"});
        pixel_objects const objects(to_uv_view(maps), {3, 4});
        stack<Real, 4> images({1, 2, 3, 4});
        for (std::size_t row = 0; row < 3; ++row) {
            for (std::size_t column = 0; column < 4; ++column) {
                images(0, 0, row, column) = static_cast<Real>(3 * column + 4 * row);
                images(0, 1, row, column) = static_cast<Real>(1 - 3.0 * static_cast<double>(column));
            }
        }
        CHECK(*sharpness(images.view(), objects) == doctest::Approx(std::sqrt((9 + 16 + 9) / 2.0)));
    }

    TEST_CASE_TEMPLATE("silhouettes are not steep", Real, float, double) {
        // Each object is even, but they and the background differ: only pixels with both neighbours in the object
        // count.
        auto const maps = drawn_maps({"aabb aabb aa.."});
        pixel_objects const objects(to_uv_view(maps), {3, 4});
        stack<Real, 4> images({1, 1, 3, 4});
        for (std::size_t row = 0; row < 3; ++row) {
            images(0, 0, row, 0) = images(0, 0, row, 1) = 5;
            images(0, 0, row, 2) = images(0, 0, row, 3) = row < 2 ? 1 : 0;
        }
        CHECK(*sharpness(images.view(), objects) == 0.0);
        // One step in object 0: between rows 1 and 2 of one of its two pixels that count.
        images(0, 0, 2, 0) = 7;
        CHECK(*sharpness(images.view(), objects) == doctest::Approx(2.0 / 3));
        CHECK(*sharpness(images.view(), objects, [](object_index o) { return o.value == 0; }) == doctest::Approx(1));
        CHECK(*sharpness(images.view(), objects, [](object_index o) { return o.value == 1; }) == 0.0);
    }

    TEST_CASE("no object has no sharpness and images of other extents are refused") {
        auto const maps = drawn_maps({"a. .a"});
        pixel_objects const objects(to_uv_view(maps), {2, 2});
        CHECK_FALSE(sharpness(stack<float, 4>({1, 1, 2, 2}).view(), objects).has_value());
        CHECK_THROWS_WITH_AS(sharpness(stack<float, 4>({1, 1, 2, 3}).view(), objects),
                             "sharpness: images is [1, 1, 2, 3], expected [1, 1, 2, 2]", shape_error);
    }
}
