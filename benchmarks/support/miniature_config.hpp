// SPDX-License-Identifier: MIT
// The architecture of the miniature, whose weights are in examples/miniature, for programs that read no files.
#pragma once

#include <genrender/reference/unet_config.hpp>

#include <cstddef>

namespace genrender::benchmarks {

using namespace genrender::reference;

/// UNet and ControlNet of the miniature.
inline unet_config miniature_config() {
    unet_config config;
    config.in_channels = config.out_channels = 8;
    config.block_out_channels = {48, 96, 96};
    config.level_has_attention = {false, true, false};
    config.level_has_attention_up = {true, true, false};
    config.layers_per_block = 1;
    config.attention_head_dim = {1, 3, 3};
    config.cross_attention_dim = 64;
    config.norm_num_groups = 8;
    config.conditioning_embedding_out_channels = {8, 16, 32};
    config.prediction_type = prediction::velocity;
    return config;
}

/// Tokens of a prompt of the miniature, as many as CLIP's.
inline constexpr std::size_t miniature_prompt_tokens = 77;

} // namespace genrender::benchmarks
