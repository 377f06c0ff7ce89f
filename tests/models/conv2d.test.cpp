// SPDX-License-Identifier: MIT
// Tests of the convolution.
#include <genrender/models/conv2d.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("models/conv2d") {
    TEST_CASE_TEMPLATE("kernels of 3 and 1 and strides of 1 and 2 agree with the definition", Real, float, double) {
        for (auto const grid : {grid_extents{6, 8}, grid_extents{5, 3}, grid_extents{1, 1}, grid_extents{2, 7}}) {
            for (std::size_t const kernel : {1U, 3U}) {
                for (std::size_t const stride : {1U, 2U}) {
                    auto source = weights<Real>::seeded(kernel, "test");
                    conv2d<Real> const conv(source, "conv", 3, 4, kernel, stride);
                    auto const in = random_stack<Real, 2>({grid.size(), 3}, stride);
                    auto const expected =
                        plain_conv2d<Real>(in, grid, source.take("conv.weight", {4, 3, kernel, kernel}),
                                           source.take("conv.bias", {4}), kernel, stride);
                    stack<Real, 2> out({conv.out_grid(grid).size(), 4});
                    conv(out.view(), in, grid);
                    check_close<Real, 2>(out.view(), expected);
                }
            }
        }
    }

    TEST_CASE_TEMPLATE("maps of more than one tile agree with the definition", Real, float, double) {
        grid_extents const grid{20, 17};
        auto source = weights<Real>::seeded(1, "test");
        conv2d<Real> const conv(source, "conv", 90, 2);
        auto const in = random_stack<Real, 2>({grid.size(), 90}, 5);
        stack<Real, 2> out({grid.size(), 2});
        conv(out.view(), in, grid);
        check_close<Real, 2>(out.view(), plain_conv2d<Real>(in, grid, source.take("conv.weight", {2, 90, 3, 3}),
                                                            source.take("conv.bias", {2}), 3, 1));
    }

    TEST_CASE("extents that do not fit are refused") {
        auto source = weights<float>::seeded(1, "test");
        conv2d<float> const conv(source, "conv", 3, 2, 3, 2);
        stack<float, 2> in({16, 3});
        stack<float, 2> out({16, 2});
        CHECK_THROWS_WITH_AS(conv(out.view(), in, {4, 4}), "conv2d: out is [16, 2], expected [4, 2]", shape_error);
        CHECK_THROWS_WITH_AS(conv(out.view(), in, {4, 5}), "conv2d: in is [16, 3], expected [20, 3]", shape_error);
    }
}
