// SPDX-License-Identifier: MIT
// Tests of the residual block.
#include <genrender/reference/resnet_block.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

namespace {

/// GroupNorm with 4 groups and scales of 1, then SiLU, by their definitions.
template <class Real>
stack<Real, 2> plain_norm_silu(in_view<Real, 2> in, std::vector<Real> const& bias) {
    stack<Real, 2> out(in.extents());
    auto const size = in.extent(1) / 4;
    auto const count = static_cast<double>(size * in.extent(0));
    for (std::size_t c = 0; c < in.extent(1); ++c) {
        double sum = 0;
        double squares = 0;
        for (std::size_t k = c / size * size; k < (c / size + 1) * size; ++k) {
            for (std::size_t t = 0; t < in.extent(0); ++t) {
                sum += static_cast<double>(in(t, k));
                squares += static_cast<double>(in(t, k)) * static_cast<double>(in(t, k));
            }
        }
        auto const mean = sum / count;
        auto const deviation = std::sqrt(squares / count - mean * mean + 1e-5);
        for (std::size_t t = 0; t < in.extent(0); ++t) {
            auto const x = (static_cast<double>(in(t, c)) - mean) / deviation + static_cast<double>(bias[c]);
            out(t, c) = static_cast<Real>(x / (1 + std::exp(-x)));
        }
    }
    return out;
}

template <class Real>
void check_resnet(std::size_t in, std::size_t out) {
    auto const config = small_config();
    auto source = weights<Real>::seeded(1, "test");
    resnet_block<Real> const block(config, source, "r", in, out);
    small_pass<Real> const small;
    grid_extents const grid{4, 6};
    auto const x = random_maps<Real>(2, grid, in, 3);
    auto const y = block(small.pass, x);
    CHECK(y.grid() == grid);
    auto const time = plain_linear<Real>(strided_view<Real const, 2>(small.pass.time.data(), {1, 32}),
                                         source.take("r.time_emb_proj.weight", {out, 32}),
                                         source.take("r.time_emb_proj.bias", {out}), out);
    for (std::size_t i = 0; i < 2; ++i) {
        auto h = plain_conv2d<Real>(plain_norm_silu<Real>(x[i], source.take("r.norm1.bias", {in})), grid,
                                    source.take("r.conv1.weight", {out, in, 3, 3}), source.take("r.conv1.bias", {out}),
                                    3, 1);
        for (std::size_t t = 0; t < grid.size(); ++t) {
            for (std::size_t c = 0; c < out; ++c) {
                h(t, c) += time(0, c);
            }
        }
        auto expected = plain_conv2d<Real>(plain_norm_silu<Real>(h, source.take("r.norm2.bias", {out})), grid,
                                           source.take("r.conv2.weight", {out, out, 3, 3}),
                                           source.take("r.conv2.bias", {out}), 3, 1);
        if (in == out) {
            add_scaled(expected.view(), x[i]);
        } else {
            auto const shortcut = plain_conv2d<Real>(x[i], grid, source.take("r.conv_shortcut.weight", {out, in, 1, 1}),
                                                     source.take("r.conv_shortcut.bias", {out}), 1, 1);
            add_scaled(expected.view(), shortcut);
        }
        check_close<Real const, 2>(y[i], expected);
    }
}

} // namespace

TEST_SUITE("reference/resnet_block") {
    TEST_CASE_TEMPLATE("a block is the sum of its branch and its input", Real, float, double) {
        check_resnet<Real>(8, 8);
    }

    TEST_CASE_TEMPLATE("a block that changes the channels projects its input", Real, float, double) {
        check_resnet<Real>(8, 12);
    }
}
