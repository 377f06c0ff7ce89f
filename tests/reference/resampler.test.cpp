// SPDX-License-Identifier: MIT
// Tests of the steps between levels.
#include <genrender/reference/resampler.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/resampler") {
    TEST_CASE_TEMPLATE("every token becomes a square of four", Real, float, double) {
        stack<Real, 2> in({2, 1});
        in(0, 0) = 1;
        in(1, 0) = 2;
        padded_map<Real> out({2, 4}, 1);
        repeat_twice(out, in, {1, 2});
        for (std::size_t e = 0; e < 8; ++e) {
            CHECK(out.row(e / 4)[e % 4] == (e % 4 < 2 ? 1 : 2));
        }
        CHECK_THROWS_WITH_AS(repeat_twice(out, in, {2, 2}), "repeat_twice: in is [2, 1], expected [4, 1]", shape_error);
        CHECK_THROWS_WITH_AS(repeat_twice(out, in, {2, 1}), "repeat_twice: grid of out is [2, 4], expected [4, 2]",
                             shape_error);
    }

    TEST_CASE_TEMPLATE("down is a convolution of stride 2 and up one of the repeated map", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        downsampler<Real> const down(source, "down", 3);
        upsampler<Real> const up(source, "up", 3);
        small_pass<Real> const small;
        auto const x = random_maps<Real>(2, {4, 6}, 3, 2);
        auto const halved = down(small.pass, x);
        auto const doubled = up(small.pass, x);
        CHECK(halved.grid() == grid_extents{2, 3});
        CHECK(doubled.grid() == grid_extents{8, 12});
        stack<Real, 2> repeated({96, 3});
        for (std::size_t token = 0; token < 96; ++token) {
            copy(repeated.view()[token], in_view<Real, 1>(x[1][token / 24 * 6 + token % 12 / 2]));
        }
        check_close<Real const, 2>(halved[1],
                                   plain_conv2d<Real>(x[1], {4, 6}, source.take("down.conv.weight", {3, 3, 3, 3}),
                                                      source.take("down.conv.bias", {3}), 3, 2));
        check_close<Real const, 2>(doubled[1],
                                   plain_conv2d<Real>(repeated, {8, 12}, source.take("up.conv.weight", {3, 3, 3, 3}),
                                                      source.take("up.conv.bias", {3}), 3, 1));
    }
}
