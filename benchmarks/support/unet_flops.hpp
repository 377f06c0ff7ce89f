// SPDX-License-Identifier: MIT
// The FLOPs of a UNet that there is no room or time to run, counted from its architecture.
#pragma once

#include <genrender/core/index.hpp>
#include <genrender/reference/unet_config.hpp>
#include <genrender/reference/unet_encoder.hpp>

#include <cstddef>

namespace genrender::benchmarks {

using namespace genrender::reference;

namespace detail {

/// Sums up products; all are in multiply-adds.
class unet_products {
public:
    unet_products(unet_config const& config, grid_extents grid, std::size_t prompt_tokens)
        : config_(&config), grid_(grid), prompt_(prompt_tokens) {}

    double sum() const { return sum_; }

    std::size_t tokens(std::size_t level) const { return (grid_.height >> level) * (grid_.width >> level); }

    void add(std::size_t rows, std::size_t in, std::size_t out) {
        sum_ += static_cast<double>(rows) * static_cast<double>(in) * static_cast<double>(out);
    }

    /// A 3 x 3 convolution with the tokens of a level as output.
    void add_convolution(std::size_t level, std::size_t in, std::size_t out) { add(tokens(level), 9 * in, out); }

    /// Two convolutions, what the first is told of the time, and the way around them.
    void add_resnet(std::size_t level, std::size_t in, std::size_t out) {
        add_convolution(level, in, out);
        add_convolution(level, out, out);
        add(1, config_->time_channels(), out);
        if (in != out) {
            add(tokens(level), in, out);
        }
    }

    /// Self-attention, attention to the prompt and the feed-forward network (GEGLU), between two projections.
    void add_transformer(std::size_t level) {
        auto const N = tokens(level);
        auto const C = config_->block_out_channels[level];
        add(N, 2 * C, C);
        for (std::size_t block = 0; block < config_->transformer_layers_per_block; ++block) {
            add(N, 4 * C, C); // Q, K, V and out
            add(N, 2 * C, N); // Q K^T and its product with V
            add(N, 2 * C, C);
            add(prompt_, 2 * config_->cross_attention_dim, C);
            add(N, 2 * C, prompt_);
            add(N, C, 8 * C);
            add(N, 4 * C, C);
        }
    }

private:
    unet_config const* config_;
    grid_extents grid_;
    std::size_t prompt_;
    double sum_ = 0;
};

} // namespace detail

/// FLOPs of one run of the UNet for one frame and one guidance branch, two a multiply-add: convolutions, projections
/// and attention; no norms, activations or ControlNet. 0.803e12 for Stable Diffusion 1.5 with latents of 64 x 64 and 77
/// tokens of a prompt. Throws value_error as require_config and require_latent_grid do.
inline double unet_flops(unet_config const& config, grid_extents latents, std::size_t prompt_tokens) {
    require_config(config);
    require_latent_grid(config, latents);
    detail::unet_products products(config, latents, prompt_tokens);
    auto const& channels = config.block_out_channels;
    auto const last = config.levels() - 1;
    products.add(1, channels.front() + config.time_channels(), config.time_channels());
    products.add_convolution(0, config.in_channels, channels.front());

    // The way down and the bottom.
    for (std::size_t level = 0; level <= last; ++level) {
        auto in = channels[level == 0 ? 0 : level - 1];
        for (std::size_t i = 0; i < config.layers_per_block; ++i) {
            products.add_resnet(level, in, channels[level]);
            if (config.level_has_attention[level]) {
                products.add_transformer(level);
            }
            in = channels[level];
        }
        if (level < last) {
            products.add_convolution(level + 1, in, in);
        }
    }
    products.add_resnet(last, channels[last], channels[last]);
    products.add_transformer(last);
    products.add_resnet(last, channels[last], channels[last]);

    // The way up, which takes the skips from the last to the first.
    auto skips = skip_channels(config);
    auto in = channels[last];
    for (auto level = last + 1; level-- > 0;) {
        for (std::size_t i = 0; i <= config.layers_per_block; ++i) {
            products.add_resnet(level, in + skips.back(), channels[level]);
            skips.pop_back();
            if (config.has_attention_up(level)) {
                products.add_transformer(level);
            }
            in = channels[level];
        }
        if (level > 0) {
            products.add_convolution(level - 1, in, in);
        }
    }
    products.add_convolution(0, channels.front(), config.out_channels);
    return 2 * products.sum();
}

} // namespace genrender::benchmarks
