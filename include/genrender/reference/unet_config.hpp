// SPDX-License-Identifier: MIT
// The architecture of a denoising UNet and the ControlNet beside it, in the field names of diffusers' config.json.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace genrender::reference {

/// What diffusers' `UNet2DConditionModel` and `ControlNetModel` are built from, and what its scheduler says of their
/// training. The defaults are Stable Diffusion 1.5 and its ControlNet for depth.
struct unet_config {
    std::size_t in_channels = 4;  ///< of the latents
    std::size_t out_channels = 4; ///< of the prediction
    /// From the finest level; each next halves the grid.
    std::vector<std::size_t> block_out_channels{320, 640, 1280, 1280};
    /// down_block_types: CrossAttnDownBlock2D or DownBlock2D.
    std::vector<bool> level_has_attention{true, true, true, false};
    std::vector<bool> level_has_attention_up{}; ///< of the way up, from the finest level too; empty: as on the way down
    std::size_t layers_per_block = 2;           ///< resnets a level on the way down; one more on the way up
    std::vector<std::size_t> attention_head_dim{8, 8, 8, 8}; ///< a level; it is the *number* of heads, as in SD 1.5
    std::size_t transformer_layers_per_block = 1;            ///< transformer blocks of every attention
    bool use_linear_projection = false;                      ///< the ways in and out of attention are no convolutions
    std::size_t cross_attention_dim = 768;                   ///< channels of a prompt token
    std::size_t norm_num_groups = 32;                        ///< of every GroupNorm
    std::size_t conditioning_channels = 3;                   ///< of the ControlNet's hint
    /// Of the hint's way to the latents' size; each after the first halves it.
    std::vector<std::size_t> conditioning_embedding_out_channels{16, 32, 96, 256};

    prediction prediction_type = prediction::epsilon; ///< what the output stands for
    std::size_t num_train_timesteps = 1000;           ///< discrete noise levels of the training
    double beta_start = 0.00085;                      ///< of scaled_linear_alphas_cumprod
    double beta_end = 0.012;                          ///< of scaled_linear_alphas_cumprod

    /// Number of resolutions.
    std::size_t levels() const { return block_out_channels.size(); }
    /// Channels of the embedding of time, 4 * block_out_channels[0].
    std::size_t time_channels() const { return 4 * block_out_channels.front(); }
    /// Pixels of the hint along one latent pixel.
    std::size_t hint_scale() const { return std::size_t{1} << (conditioning_embedding_out_channels.size() - 1); }
    /// Whether there is attention on the way up at a level, 0 the finest.
    bool has_attention_up(std::size_t level) const {
        return level_has_attention_up.empty() ? level_has_attention[level] : level_has_attention_up[level];
    }
    /// What height and width of the latents must be divisible by.
    std::size_t grid_divisor() const { return std::size_t{1} << (levels() - 1); }
};

/// Throws value_error unless a network can be built: at least one level, at most 16, one entry a level everywhere, no
/// zero, groups that divide the channels they normalise, heads that divide theirs.
inline void require_config(unet_config const& config) {
    auto const function = "unet_config";
    auto const one_a_level = "one entry for each of block_out_channels";
    // More could not be halved anyway, and the factors of the grids must fit their type.
    auto const fits = [](std::size_t size) { return size >= 1 && size <= 16; };
    require_value(fits(config.levels()), function, "block_out_channels.size()", config.levels(), "1 to 16");
    require_value(config.level_has_attention.size() == config.levels(), function, "level_has_attention.size()",
                  config.level_has_attention.size(), one_a_level);
    require_value(config.level_has_attention_up.empty() || config.level_has_attention_up.size() == config.levels(),
                  function, "level_has_attention_up.size()", config.level_has_attention_up.size(),
                  "none, or one entry for each of block_out_channels");
    require_value(config.attention_head_dim.size() == config.levels(), function, "attention_head_dim.size()",
                  config.attention_head_dim.size(), one_a_level);
    auto const& embedding = config.conditioning_embedding_out_channels;
    require_value(fits(embedding.size()), function, "conditioning_embedding_out_channels.size()", embedding.size(),
                  "1 to 16");
    for (auto const channels : embedding) {
        require_value(channels > 0, function, "conditioning_embedding_out_channels", channels, "above 0");
    }
    auto const counts = {config.in_channels,
                         config.out_channels,
                         config.layers_per_block,
                         config.cross_attention_dim,
                         config.norm_num_groups,
                         config.conditioning_channels,
                         config.transformer_layers_per_block};
    for (auto const count : counts) {
        require_value(count > 0, function, "a count", count, "above 0");
    }
    for (std::size_t level = 0; level < config.levels(); ++level) {
        auto const channels = config.block_out_channels[level];
        auto const heads = config.attention_head_dim[level];
        require_value(channels > 0 && channels % config.norm_num_groups == 0, function, "block_out_channels", channels,
                      "multiples of norm_num_groups");
        require_value(heads > 0 && channels % heads == 0, function, "attention_head_dim", heads,
                      "divisors of block_out_channels of their level");
    }
    require_value(config.block_out_channels.front() % 2 == 0, function, "block_out_channels",
                  config.block_out_channels.front(), "an even number for the sines and cosines of time");
}

/// Throws value_error unless latents of this grid can be halved as often as the network does.
inline void require_latent_grid(unet_config const& config, grid_extents grid) {
    auto const expected = "a multiple of " + std::to_string(config.grid_divisor()) + " above 0";
    auto const fits = [&](std::size_t extent) { return extent > 0 && extent % config.grid_divisor() == 0; };
    require_value(fits(grid.height), "unet_config", "height of the latents", grid.height, expected.c_str());
    require_value(fits(grid.width), "unet_config", "width of the latents", grid.width, expected.c_str());
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
