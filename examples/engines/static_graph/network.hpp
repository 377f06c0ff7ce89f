// SPDX-License-Identifier: MIT
// A small network of a UNet's parts, written once over the operations of any engine, with seeded weights.
#pragma once

#include <genrender/attention/attention_site.hpp>
#include <genrender/core/random.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace genrender::examples {

/// A linear layer's weights, [outputs, inputs] row-major.
struct layer_weights {
    std::size_t inputs = 0;
    std::size_t outputs = 0;
    std::vector<float> values;
};

/// Two resolutions, a skip between them, self-attention and a feed-forward network at each, without convolutions.
struct small_unet {
    static constexpr grid_extents grid{16, 16};
    static constexpr grid_extents coarse{8, 8};
    static constexpr std::size_t latent_channels = 4;
    static constexpr std::size_t channels = 32;
    static constexpr std::size_t heads = 2;
    static constexpr std::size_t prompts = 2; // branches
    static constexpr float epsilon = 1e-5f;

    struct block {
        layer_weights query = layer(1, channels, channels, 2.0f);
        layer_weights key = layer(2, channels, channels, 2.0f);
        layer_weights value = layer(3, channels, channels, 1.0f);
        layer_weights out = layer(4, channels, channels, 1.0f);
        layer_weights widen = layer(5, channels, 2 * channels, 1.0f);
        layer_weights narrow = layer(6, 2 * channels, channels, 1.0f);
    };
    layer_weights first = layer(7, latent_channels, channels, 1.0f);
    layer_weights last = layer(8, channels, latent_channels, 0.7f);
    std::array<block, 3> blocks{};
    std::array<attention_site, 3> sites{
        {{"down.attn1", network_kind::denoising, network_part::encoder, grid, channels},
         {"middle.attn1", network_kind::denoising, network_part::decoder, coarse, channels},
         {"up.attn1", network_kind::denoising, network_part::decoder, grid, channels}}};

    /// All that have weights.
    std::vector<layer_weights const*> layers() const {
        std::vector<layer_weights const*> all{&first, &last};
        for (auto const& b : blocks) {
            all.insert(all.end(), {&b.query, &b.key, &b.value, &b.out, &b.widen, &b.narrow});
        }
        return all;
    }

    /// What a noise level and a prompt add to every token [channels].
    static std::vector<float> shift(float sigma, std::uint32_t prompt) {
        std::vector<float> values(channels);
        for (std::uint32_t c = 0; c < channels; ++c) {
            auto const time = std::sin(std::log1p(sigma) * static_cast<float>(c + 1) / 4);
            values[c] = 0.5f * time + 0.5f * normal(9, c, prompt);
        }
        return values;
    }

    /// Latents [frames, tokens, latent channels] by the operations of an engine: `linear(weights, x)`, `add(a, b)`, where b
    /// may be one token for all, `silu`, `normalized` (mean 0 and variance 1 of each token), `pooled` and `enlarged` (cells
    /// of 2 x 2 tokens of a grid), and `attention(site, block, f)`.
    template <class Operations, class Tensor>
    Tensor operator()(Operations& ops, Tensor const& z, Tensor const& shift) const {
        auto const fine = run(ops, 0, ops.add(ops.linear(first, z), shift));
        auto const middle = run(ops, 1, ops.pooled(fine, grid));
        auto const up = run(ops, 2, ops.add(ops.enlarged(middle, coarse), fine));
        return ops.linear(last, ops.normalized(up));
    }

private:
    template <class Operations, class Tensor>
    Tensor run(Operations& ops, std::uint32_t site, Tensor const& x) const {
        auto const& b = blocks[site];
        auto const F = ops.attention(site_index{site}, b, ops.normalized(x));
        auto const y = ops.add(x, ops.linear(b.out, F));
        return ops.add(y, ops.linear(b.narrow, ops.silu(ops.linear(b.widen, ops.normalized(y)))));
    }

    static float normal(std::uint32_t layer, std::uint32_t i, std::uint32_t j) {
        return static_cast<float>(normal_value(15, random_stream::weights, {layer, i, j}));
    }
    static layer_weights layer(std::uint32_t name, std::size_t inputs, std::size_t outputs, float gain) {
        layer_weights w{inputs, outputs, std::vector<float>(inputs * outputs)};
        for (std::uint32_t o = 0; o < outputs; ++o) {
            for (std::uint32_t i = 0; i < inputs; ++i) {
                w.values[o * inputs + i] = gain * normal(name, o, i) / std::sqrt(static_cast<float>(inputs));
            }
        }
        return w;
    }
};

} // namespace genrender::examples
