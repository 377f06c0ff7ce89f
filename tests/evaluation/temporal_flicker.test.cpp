// SPDX-License-Identifier: MIT
// VBench's temporal flickering by hand.
#include <genrender/evaluation/temporal_flicker.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("evaluation/temporal_flicker") {
    TEST_CASE_TEMPLATE("it is one less the mean of absolute changes, whatever their sign", Real, float, double) {
        stack<Real, 4> images({3, 2, 1, 2});
        images(1, 0, 0, 0) = Real(0.5);  // up by .5 and down by .5: 1 in all
        images(2, 1, 0, 1) = Real(0.25); // up by .25 at the end
        CHECK(*temporal_flicker(images.view()) == doctest::Approx(1 - 1.25 / 8));
    }

    TEST_CASE("frames that are alike have one") {
        stack<float, 4> images({4, 3, 2, 2});
        CHECK(*temporal_flicker(images.view()) == 1.0);
    }

    TEST_CASE("a single frame and frames without pixels have none") {
        CHECK_FALSE(temporal_flicker(stack<float, 4>({1, 3, 2, 2}).view()));
        CHECK_FALSE(temporal_flicker(stack<float, 4>({3, 3, 0, 2}).view()));
        CHECK_FALSE(temporal_flicker(stack<float, 4>({3, 0, 2, 2}).view()));
    }
}
