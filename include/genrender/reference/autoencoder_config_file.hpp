// SPDX-License-Identifier: MIT
// The config.json of an autoencoder of pictures, as diffusers writes it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/autoencoder_config.hpp>
#include <genrender/reference/config_file.hpp>

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace genrender::reference {

/// The architecture in the config.json of an AutoencoderKL. Absent options have diffusers' defaults. Throws file_error
/// naming the option that is unknown or has a value that the networks here cannot follow; value_error as require_config
/// does.
inline autoencoder_config read_autoencoder_config(config_file file) {
    file.expect("_class_name", {"AutoencoderKL"});
    file.expect("in_channels", {3});
    file.expect("out_channels", {3});
    autoencoder_config config;
    config.block_out_channels = file.counts("block_out_channels", {64});
    auto const levels = config.levels();
    auto const require_types = [&](char const* option, char const* type) {
        auto const types = file.texts(option, {type});
        file.require(types == std::vector<std::string>(levels, type), option,
                     std::to_string(levels) + " times \"" + type + "\", one for each of block_out_channels");
    };
    require_types("down_block_types", "DownEncoderBlock2D");
    require_types("up_block_types", "UpDecoderBlock2D");
    config.layers_per_block = file.count("layers_per_block", 1);
    config.latent_channels = file.count("latent_channels", 4);
    config.norm_num_groups = file.count("norm_num_groups", 32);
    config.scaling_factor = file.number("scaling_factor", 0.18215);
    file.require(config.scaling_factor > 0, "scaling_factor", "a number above 0");
    config.shift_factor = file["shift_factor"].is_null() ? 0 : file.number("shift_factor", 0);
    config.mid_block_add_attention = file.flag("mid_block_add_attention", true);
    config.use_quant_conv = file.flag("use_quant_conv", true);
    config.use_post_quant_conv = file.flag("use_post_quant_conv", true);
    file.expect("act_fn", {"silu", "swish"});
    file.expect("latents_mean", {nullptr});
    file.expect("latents_std", {nullptr});
    // Names and versions; the size of pictures in training; a precision that is ours anyway.
    file.ignore({"_diffusers_version", "_name_or_path", "sample_size", "force_upcast", "shift_factor"});
    file.require_all_taken();
    require_config(config);
    return config;
}

/// The config.json of an AutoencoderKL.
inline nlohmann::json autoencoder_json(autoencoder_config const& config) {
    return {{"_class_name", "AutoencoderKL"},
            {"in_channels", 3},
            {"out_channels", 3},
            {"block_out_channels", config.block_out_channels},
            {"down_block_types", std::vector<std::string>(config.levels(), "DownEncoderBlock2D")},
            {"up_block_types", std::vector<std::string>(config.levels(), "UpDecoderBlock2D")},
            {"layers_per_block", config.layers_per_block},
            {"latent_channels", config.latent_channels},
            {"norm_num_groups", config.norm_num_groups},
            {"scaling_factor", config.scaling_factor},
            {"shift_factor", config.shift_factor == 0 ? nlohmann::json() : nlohmann::json(config.shift_factor)},
            {"mid_block_add_attention", config.mid_block_add_attention},
            {"use_quant_conv", config.use_quant_conv},
            {"use_post_quant_conv", config.use_post_quant_conv}};
}
} // namespace genrender::reference

#include <genrender/core/end_header.inl>
