// SPDX-License-Identifier: MIT
// Deviations of small objects by hand.
#include <genrender/evaluation/contrast.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <genrender/testing/random_stack.hpp>
#include "support/small_maps.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

using namespace genrender;
using genrender::testing::drawn_maps;
using genrender::testing::random_stack;

namespace {

/// Two frames of four rows: object 0 on the left, object 1 on the right of a column of background; object 1 is too
/// small in frame 1.
uv_maps two_objects() {
    return drawn_maps({"aaaa.bbbb aaaa.bbbb aaaa.bbbb aaaa.bbbb", "aaaa.bbbb aaaa.bbbb aaaa.bbbb aaaa....."});
}

/// Whether a column belongs to object 1.
bool is_right(std::size_t column) { return column > 4; }

} // namespace

TEST_SUITE("evaluation/contrast") {
    TEST_CASE_TEMPLATE("half of an object bright and half dark deviates by half of their difference", Real, float,
                       double) {
        auto const maps = two_objects();
        pixel_objects const objects(to_uv_view(maps), {4, 9});
        stack<Real, 4> images({2, 1, 4, 9});
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t row = 0; row < 4; ++row) {
                for (std::size_t column = 0; column < 9; ++column) {
                    // Object 0 deviates by 0.25 in frame 0 and 0.5 in frame 1, object 1 by 1; the background is NaN.
                    auto const size = is_right(column) ? 1.0 : i == 0 ? 0.25 : 0.5;
                    images(i, 0, row, column) = column == 4 ? std::numeric_limits<Real>::quiet_NaN()
                                                            : static_cast<Real>(3 + (row < 2 ? size : -size));
                }
            }
        }
        // Object 1 has 12 pixels in frame 1, fewer than are asked for.
        CHECK(*contrast(images.view(), objects) == doctest::Approx((0.25 + 1 + 0.5) / 3));
        CHECK(*contrast(images.view(), objects, [](object_index o) { return o.value == 0; }) ==
              doctest::Approx((0.25 + 0.5) / 2));
        CHECK(*contrast(images.view(), objects, [](object_index o) { return o.value == 1; }) == doctest::Approx(1));
    }

    TEST_CASE("channels are averaged before the root") {
        auto const maps = two_objects();
        pixel_objects const objects(to_uv_view(maps), {4, 9});
        stack<double, 4> images({2, 2, 4, 9});
        for (std::size_t column = 0; column < 9; ++column) {
            for (std::size_t row = 0; row < 4; ++row) {
                images(0, 0, row, column) = row % 2 == 0 ? 3 : -3;
                images(0, 1, row, column) = row % 2 == 0 ? 4 : -4;
            }
        }
        auto const first = [](object_index o) { return o.value == 0; };
        // Frame 1 is even: its deviation is 0.
        CHECK(*contrast(images.view(), objects, first) == doctest::Approx(std::sqrt(25.0 / 2) / 2));
    }

    TEST_CASE("an image that is blurred has less contrast") {
        auto const maps = two_objects();
        pixel_objects const objects(to_uv_view(maps), {4, 9});
        auto const images = random_stack<double, 4>({2, 3, 4, 9}, 4);
        stack<double, 4> blurred({2, 3, 4, 9});
        for (std::size_t e = 0; e + 1 < images.size(); ++e) {
            blurred.data()[e] = (images.data()[e] + images.data()[e + 1]) / 2;
        }
        CHECK(*contrast(blurred.view(), objects) < 0.85 * *contrast(images.view(), objects));
    }

    TEST_CASE("no object has no contrast and images of other extents are refused") {
        auto const maps = two_objects();
        pixel_objects const objects(to_uv_view(maps), {4, 9});
        stack<float, 4> const images({2, 1, 4, 9});
        CHECK_FALSE(contrast(images.view(), objects, [](object_index) { return false; }).has_value());
        CHECK_FALSE(contrast(stack<float, 4>({2, 0, 4, 9}).view(), objects).has_value());
        CHECK_THROWS_WITH_AS(contrast(stack<float, 4>({2, 1, 9, 4}).view(), objects),
                             "contrast: images is [2, 1, 9, 4], expected [2, 1, 4, 9]", shape_error);
    }
}
