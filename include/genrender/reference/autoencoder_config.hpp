// SPDX-License-Identifier: MIT
// The architecture of an autoencoder of pictures.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/index.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace genrender::reference {

/// What diffusers' `AutoencoderKL` is built from, in its field names. The defaults are the VAE of Stable Diffusion 1.x
/// and 2.x. Pictures have 3 channels.
struct autoencoder_config {
    std::vector<std::size_t> block_out_channels{128, 256, 512, 512}; ///< from the finest level; each next halves
    std::size_t layers_per_block = 2;    ///< resnets a level of the encoder; one more of the decoder
    std::size_t latent_channels = 4;     ///< channels of a latent
    std::size_t norm_num_groups = 32;    ///< of every GroupNorm
    double scaling_factor = 0.18215;     ///< the diffusion's latents are (z - shift_factor) scaling_factor
    double shift_factor = 0;             ///< 0 where the file says null
    bool mid_block_add_attention = true; ///< attention at the latents' resolution, in one head
    bool use_quant_conv = true;          ///< a 1x1 convolution after the encoder
    bool use_post_quant_conv = true;     ///< a 1x1 convolution before the decoder

    /// Number of resolutions.
    std::size_t levels() const { return block_out_channels.size(); }
    /// Pixels along a side of a token of the latents.
    std::size_t scale() const { return std::size_t{1} << (levels() - 1); }
};

/// Throws value_error unless an autoencoder can be built: 1 to 16 levels, no zero, groups that divide the channels, a
/// scaling factor above 0.
inline void require_config(autoencoder_config const& config) {
    auto const function = "autoencoder_config";
    require_value(config.levels() >= 1 && config.levels() <= 16, function, "block_out_channels.size()", config.levels(),
                  "1 to 16");
    for (auto const count : {config.layers_per_block, config.latent_channels, config.norm_num_groups}) {
        require_value(count > 0, function, "a count", count, "above 0");
    }
    for (auto const channels : config.block_out_channels) {
        require_value(channels > 0 && channels % config.norm_num_groups == 0, function, "block_out_channels", channels,
                      "multiples of norm_num_groups");
    }
    require_value(is_finite(config.scaling_factor) && config.scaling_factor > 0, function, "scaling_factor",
                  config.scaling_factor, "a finite number above 0");
    require_value(is_finite(config.shift_factor), function, "shift_factor", config.shift_factor, "a finite number");
}

/// Throws value_error unless pictures of this grid can be halved as often as the encoder does.
inline void require_picture_grid(autoencoder_config const& config, grid_extents grid) {
    auto const expected = "a multiple of " + std::to_string(config.scale()) + " above 0";
    auto const fits = [&](std::size_t extent) { return extent > 0 && extent % config.scale() == 0; };
    require_value(fits(grid.height), "autoencoder_config", "height of the picture", grid.height, expected.c_str());
    require_value(fits(grid.width), "autoencoder_config", "width of the picture", grid.width, expected.c_str());
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
