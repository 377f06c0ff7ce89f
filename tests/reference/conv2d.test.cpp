// SPDX-License-Identifier: MIT
// Tests of the convolution.
#include <genrender/reference/conv2d.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/conv2d") {
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

    TEST_CASE_TEMPLATE("channels that fill registers and those that do not agree with the definition", Real, float,
                       double) {
        grid_extents const grid{9, 7};
        for (std::size_t const ins : {1U, 8U, 20U}) {
            for (std::size_t const outs : {1U, 16U, 37U, 64U}) {
                for (std::size_t const stride : {1U, 2U}) {
                    auto source = weights<Real>::seeded(1, "test");
                    conv2d<Real> const conv(source, "conv", ins, outs, 3, stride);
                    auto const in = random_stack<Real, 2>({grid.size(), ins}, 5);
                    auto const expected = plain_conv2d<Real>(in, grid, source.take("conv.weight", {outs, ins, 3, 3}),
                                                             source.take("conv.bias", {outs}), 3, stride);
                    stack<Real, 2> out(expected.extents());
                    conv(out.view(), in, grid);
                    check_close<Real, 2>(out.view(), expected);

                    // A residual, and other numbers in the place of the bias.
                    auto const residual = random_stack<Real, 2>(out.extents(), 6);
                    std::vector<Real> const shift(outs, Real(0.5));
                    conv(out.view(), padded_map<Real>(in, grid), {shift, residual});
                    auto sum = expected;
                    for (std::size_t e = 0; e < sum.size(); ++e) {
                        sum.data()[e] += shift[e % outs] - conv.bias()[e % outs] + residual.data()[e];
                    }
                    check_close<Real, 2>(out.view(), sum);
                }
            }
        }
    }

    TEST_CASE_TEMPLATE("the result is the same to the bit on any number of threads", Real, float, double) {
        grid_extents const grid{40, 33};
        auto source = weights<Real>::seeded(1, "test");
        for (std::size_t const kernel : {1U, 3U}) {
            conv2d<Real> const conv(source, "conv" + std::to_string(kernel), 12, 20, kernel);
            auto const in = random_stack<Real, 2>({grid.size(), 12}, 5);
            stack<Real, 2> alone({grid.size(), 20});
            stack<Real, 2> shared({grid.size(), 20});
            conv(alone.view(), in, grid);
            conv(shared.view(), in, grid, threaded_loop(3));
            CHECK(std::equal(alone.data(), alone.data() + alone.size(), shared.data()));
        }
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
