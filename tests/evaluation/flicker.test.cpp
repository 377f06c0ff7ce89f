// SPDX-License-Identifier: MIT
// Changes of the background and of whole frames by hand.
#include <genrender/evaluation/flicker.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <genrender/testing/random_stack.hpp>
#include "support/small_maps.hpp"

#include <cmath>
#include <limits>

using namespace genrender;
using genrender::testing::drawn_maps;
using genrender::testing::random_stack;

TEST_SUITE("evaluation/flicker") {
    TEST_CASE_TEMPLATE("[GR sec. 3.4] only what is background in both frames flickers", Real, float, double) {
        auto const maps = drawn_maps({"a...", ".a..", "..a."});
        pixel_objects const objects(to_uv_view(maps), {1, 4});
        stack<Real, 4> images({3, 1, 1, 4});
        images(0, 0, 0, 0) = images(1, 0, 0, 1) = images(2, 0, 0, 2) = std::numeric_limits<Real>::quiet_NaN();
        images(1, 0, 0, 0) = 7; // an object was here before
        images(2, 0, 0, 0) = 7;
        CHECK(*background_flicker(images.view(), objects) == 0.0);
        // Frames 0 and 1 share pixels 2 and 3, frames 1 and 2 share 0 and 3.
        images(0, 0, 0, 2) = 3;
        images(1, 0, 0, 3) = 4;
        CHECK(*background_flicker(images.view(), objects) == doctest::Approx(std::sqrt((9 + 16 + 16) / 4.0)));
    }

    TEST_CASE("with a margin what is near an object in either frame is left out, along rows, columns and diagonals") {
        auto const maps = drawn_maps({"a.....", "a....."});
        pixel_objects const row(to_uv_view(maps), {1, 6});
        stack<double, 4> images({2, 1, 1, 6});
        images(1, 0, 0, 2) = 5;
        images(1, 0, 0, 3) = 1;
        CHECK(*background_flicker(images.view(), row) == doctest::Approx(std::sqrt((25 + 1) / 5.0)));
        CHECK(*background_flicker(images.view(), row, 2) == doctest::Approx(std::sqrt(1 / 3.0)));
        CHECK(*background_flicker(images.view(), row, 4) == 0.0);
        CHECK_FALSE(background_flicker(images.view(), row, 5).has_value());
        // An object in the middle of the first frame leaves the rim of five rows and columns with a margin of one.
        auto square = uv_maps(2, {5, 5});
        square.coverage(0, 2, 2) = 1;
        pixel_objects const around(to_uv_view(square), {5, 5});
        stack<double, 4> framed({2, 1, 5, 5});
        framed(1, 0, 1, 1) = 9; // touches the corner of the object's pixel
        framed(1, 0, 0, 4) = 2;
        CHECK(*background_flicker(framed.view(), around, 1) == doctest::Approx(std::sqrt(4 / 16.0)));
    }

    TEST_CASE("[GR sec. 3.4] independent noise flickers by the deviation of two") {
        auto const maps = drawn_maps({"........", "........", "........"});
        pixel_objects const objects(to_uv_view(maps), {1, 8});
        auto const images = random_stack<double, 4>({3, 600, 1, 8}, 3);
        CHECK(*background_flicker(images.view(), objects) == doctest::Approx(std::sqrt(2.0)).epsilon(0.03));
    }

    TEST_CASE("no common background has no flicker and images of other extents are refused") {
        auto const maps = drawn_maps({"aa..", "..aa"});
        pixel_objects const objects(to_uv_view(maps), {1, 4});
        CHECK_FALSE(background_flicker(stack<float, 4>({2, 3, 1, 4}).view(), objects).has_value());
        CHECK_THROWS_WITH_AS(background_flicker(stack<float, 4>({3, 3, 1, 4}).view(), objects),
                             "background_flicker: images is [3, 3, 1, 4], expected [2, 3, 1, 4]", shape_error);
    }

    TEST_CASE_TEMPLATE("[GR sec. 3.4] colours of frames by hand", Real, float, double) {
        // Channel 0 has means 1, 4, 4 and deviations 1, 1, 3; channel 1 does not change.
        stack<Real, 4> images({3, 2, 1, 2});
        images(0, 0, 0, 1) = 2;
        images(1, 0, 0, 0) = 3;
        images(1, 0, 0, 1) = 5;
        images(2, 0, 0, 0) = 1;
        images(2, 0, 0, 1) = 7;
        auto const found = colour_flicker(images.view());
        CHECK(found->mean == doctest::Approx(std::sqrt(9.0 / 4)));
        CHECK(found->deviation == doctest::Approx(std::sqrt(4.0 / 4)));
    }

    TEST_CASE("[GR sec. 3.4] pixels that trade places do not change the colours of a frame") {
        stack<double, 4> images({2, 1, 2, 2});
        images(0, 0, 0, 0) = images(1, 0, 1, 1) = 0.75;
        images(0, 0, 0, 1) = images(1, 0, 1, 0) = 0.5;
        CHECK(colour_flicker(images.view())->mean == 0);
        CHECK(colour_flicker(images.view())->deviation == 0);
    }

    TEST_CASE("a single frame and frames without pixels do not flicker") {
        CHECK_FALSE(colour_flicker(stack<float, 4>({1, 3, 2, 2}).view()).has_value());
        CHECK_FALSE(colour_flicker(stack<float, 4>({2, 3, 0, 2}).view()).has_value());
    }
}
