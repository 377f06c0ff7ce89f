// SPDX-License-Identifier: MIT
// The autoencoder's layers written out the long way.
#pragma once

#include "small_networks.hpp"

#include <genrender/reference/autoencoder_config.hpp>
#include <genrender/reference/spare_map.hpp>
#include <genrender/reference/weights.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace genrender::testing {

/// Two levels of 8 and 16 channels, one resnet each, in groups of 4.
inline autoencoder_config small_vae_config() {
    autoencoder_config config;
    config.block_out_channels = {8, 16};
    config.layers_per_block = 1;
    config.norm_num_groups = 4;
    return config;
}

/// Random features, the same for the same seed.
template <class Real>
spare_map<Real> random_map(grid_extents grid, std::size_t channels, std::uint64_t seed) {
    spare_map<Real> map(grid, channels);
    copy(map.view(), in_view<Real, 2>(random_stack<Real, 2>({grid.size(), channels}, seed).view()));
    return map;
}

/// GroupNorm with 4 groups, scales of 1 and epsilon 1e-6 by its definition.
template <class Real>
stack<Real, 2> plain_group_norm(in_view<Real, 2> in, std::vector<Real> const& bias) {
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
        auto const deviation = std::sqrt(squares / count - mean * mean + 1e-6);
        for (std::size_t t = 0; t < in.extent(0); ++t) {
            out(t, c) =
                static_cast<Real>((static_cast<double>(in(t, c)) - mean) / deviation + static_cast<double>(bias[c]));
        }
    }
    return out;
}

/// conv(silu(norm(in))), both with seeded weights of their names.
template <class Real>
stack<Real, 2> plain_norm_and_convolve(weights<Real>& source, std::string const& norm, std::string const& conv,
                                       in_view<Real, 2> in, grid_extents grid, std::size_t out) {
    auto normed = plain_group_norm<Real>(in, source.take(norm + ".bias", {in.extent(1)}));
    for (std::size_t i = 0; i < normed.size(); ++i) {
        auto const x = static_cast<double>(normed.data()[i]);
        normed.data()[i] = static_cast<Real>(x / (1 + std::exp(-x)));
    }
    return plain_conv2d<Real>(normed, grid, source.take(conv + ".weight", {out, in.extent(1), 3, 3}),
                              source.take(conv + ".bias", {out}), 3, 1);
}

/// vae_resnet by its formula.
template <class Real>
stack<Real, 2> plain_vae_resnet(weights<Real>& source, std::string const& name, in_view<Real, 2> x, grid_extents grid,
                                std::size_t out) {
    auto const hidden = plain_norm_and_convolve<Real>(source, name + ".norm1", name + ".conv1", x, grid, out);
    auto result = plain_norm_and_convolve<Real>(source, name + ".norm2", name + ".conv2", hidden, grid, out);
    if (x.extent(1) == out) {
        add_scaled(result.view(), x);
    } else {
        auto const weight = source.take(name + ".conv_shortcut.weight", {out, x.extent(1), 1, 1});
        auto const bias = source.take(name + ".conv_shortcut.bias", {out});
        add_scaled(result.view(), plain_conv2d<Real>(x, grid, weight, bias, 1, 1));
    }
    return result;
}

/// vae_attention by its formula.
template <class Real>
stack<Real, 2> plain_vae_attention(weights<Real>& source, std::string const& name, in_view<Real, 2> x) {
    auto const channels = x.extent(1);
    auto const normed = plain_group_norm<Real>(x, source.take(name + ".group_norm.bias", {channels}));
    auto const of = [&](std::string const& matrix, in_view<Real, 2> in) {
        return plain_linear<Real>(in, source.take(name + matrix + ".weight", {channels, channels}),
                                  source.take(name + matrix + ".bias", {channels}), channels);
    };
    auto const Q = of(".to_q", normed);
    auto const K = of(".to_k", normed);
    auto const V = of(".to_v", normed);
    stack<Real, 2> F(x.extents());
    for (std::size_t t = 0; t < x.extent(0); ++t) {
        std::vector<double> softmax;
        double sum = 0;
        for (std::size_t key = 0; key < x.extent(0); ++key) {
            double product = 0;
            for (std::size_t c = 0; c < channels; ++c) {
                product += static_cast<double>(Q(t, c)) * static_cast<double>(K(key, c));
            }
            softmax.push_back(std::exp(product / std::sqrt(static_cast<double>(channels))));
            sum += softmax.back();
        }
        for (std::size_t c = 0; c < channels; ++c) {
            double value = 0;
            for (std::size_t key = 0; key < x.extent(0); ++key) {
                value += softmax[key] / sum * static_cast<double>(V(key, c));
            }
            F(t, c) = static_cast<Real>(value);
        }
    }
    auto result = of(".to_out.0", F);
    add_scaled(result.view(), x);
    return result;
}

} // namespace genrender::testing
