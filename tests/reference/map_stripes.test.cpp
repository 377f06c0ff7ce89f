// SPDX-License-Identifier: MIT
// Tests of convolutions over stripes.
#include <genrender/reference/map_stripes.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/map_stripes") {
    TEST_CASE("a stripe takes about the bytes it is given, and at least a row") {
        CHECK(stripe_pass{{}, 0}.rows<float>({100, 8}, 4) == 1);
        CHECK(stripe_pass{{}, 1600}.rows<float>({100, 8}, 4) == 10); // 10 tokens of 4 floats a row
        CHECK(stripe_pass{{}, 1600}.rows<double>({100, 8}, 4) == 5);
        CHECK(stripe_pass{{}, 1U << 30}.rows<float>({100, 8}, 4) == 100);
    }

    TEST_CASE("stripes cover a map once and show the rows around them") {
        grid_extents const grid{7, 3};
        for (std::size_t rows = 1; rows <= 8; ++rows) {
            for (auto const& loop : {any_loop{}, any_loop(threaded_loop(3))}) {
                std::vector<std::atomic<int>> asked(grid.height);
                std::size_t next = 0;
                // A row holds its number from 1 on; 0 is the ring.
                auto const write = [&](float* to, std::size_t y) {
                    ++asked[y];
                    std::fill_n(to, 2 * grid.width, static_cast<float>(y + 1));
                };
                auto const bytes = rows * 2 * (grid.width + 2) * sizeof(float);
                each_stripe<float>(grid, 2, {loop, bytes}, write,
                                   [&](padded_map<float> const& stripe, std::size_t first, std::size_t count) {
                                       CHECK(first == next);
                                       CHECK(count == std::min(rows, grid.height - first));
                                       CHECK(stripe.grid() == grid_extents{count, grid.width});
                                       next = first + count;
                                       for (std::size_t row = 0; row < count + 2; ++row) {
                                           auto const y = first + row; // counted from the row above the map
                                           for (std::size_t x = 0; x < grid.width + 2; ++x) {
                                               auto const is_in = x > 0 && x <= grid.width && y <= grid.height;
                                               CHECK(stripe.tokens(row, x, 1) ==
                                                     (is_in ? static_cast<float>(y) : 0.0f));
                                           }
                                       }
                                       // What lies below the stripe is not needed yet.
                                       for (auto y = first + count + 1; y < grid.height; ++y) {
                                           CHECK(asked[y] == 0);
                                       }
                                   });
                CHECK(next == grid.height);
                CHECK(std::all_of(asked.begin(), asked.end(), [](auto const& count) { return count == 1; }));
            }
        }
    }

    TEST_CASE_TEMPLATE("a convolution in stripes equals that of the whole map to the bit", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        group_norm<Real> const norm(source, "norm", 8, 4, Real(1e-6));
        conv2d<Real> const conv(source, "conv", 8, 5);
        grid_extents const grid{9, 6};
        auto const in = random_stack<Real, 2>({grid.size(), 8}, 3);
        auto const residual = random_stack<Real, 2>({grid.size(), 5}, 4);
        padded_map<Real> padded(grid, 8);
        norm.with_silu(padded, in);
        stack<Real, 2> whole({grid.size(), 5});
        conv(whole.view(), padded, {conv.bias(), residual.view()});
        for (std::size_t const bytes : {1U, 1500U, 2600U, 100000U}) {
            auto out = residual;
            norm_and_convolve(out.view(), norm, conv, in, grid, {{}, bytes}, out);
            CHECK(std::equal(out.data(), out.data() + out.size(), whole.data()));
        }
        stack<Real, 2> small({1, 5});
        CHECK_THROWS_WITH_AS(norm_and_convolve(small.view(), norm, conv, in, grid, {}),
                             "norm_and_convolve: out is [1, 5], expected [54, 5]", shape_error);
    }
}
