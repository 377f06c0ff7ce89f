// SPDX-License-Identifier: MIT
// The architecture of a network as diffusers writes it: config.json of UNet and ControlNet, scheduler_config.json.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/config_file.hpp>
#include <genrender/reference/unet_config.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Every option that diffusers 0.42 writes for UNet2DConditionModel and ControlNetModel is read below: it is honoured,
// or has one supported value, or says nothing about the result. Options that are absent have diffusers' defaults. An
// option of another name is an error, because nobody knows what it would have changed.

namespace genrender::reference {

namespace internal {

inline constexpr char const* cross_attention_down = "CrossAttnDownBlock2D";
inline constexpr char const* plain_down = "DownBlock2D";
inline constexpr char const* cross_attention_up = "CrossAttnUpBlock2D";
inline constexpr char const* plain_up = "UpBlock2D";

/// Takes the options that UNet and ControlNet share.
inline void read_encoder_options(unet_config& config, config_file& file) {
    config.in_channels = file.count("in_channels", 4);
    config.block_out_channels = file.counts("block_out_channels", {320, 640, 1280, 1280});
    auto const levels = config.levels();
    auto const types =
        file.texts("down_block_types", {cross_attention_down, cross_attention_down, cross_attention_down, plain_down});
    file.require(types.size() == levels, "down_block_types", std::to_string(levels) + " names");
    config.level_has_attention.clear();
    for (auto const& type : types) {
        file.require(type == cross_attention_down || type == plain_down, "down_block_types",
                     std::string(cross_attention_down) + " or " + plain_down + " for each level");
        config.level_has_attention.push_back(type == cross_attention_down);
    }
    config.layers_per_block = file.same_count("layers_per_block", levels, 2);
    config.attention_head_dim = file.count_a_level("attention_head_dim", levels, 8);
    config.transformer_layers_per_block = file.same_count("transformer_layers_per_block", levels, 1);
    config.use_linear_projection = file.flag("use_linear_projection", false);
    config.cross_attention_dim = file.same_count("cross_attention_dim", levels, 1280);
    config.norm_num_groups = file.count("norm_num_groups", 32);

    file.expect("mid_block_type", {"UNetMidBlock2DCrossAttn"});
    file.expect("act_fn", {"silu", "swish"});
    file.expect("norm_eps", {1e-5});
    file.expect("flip_sin_to_cos", {true});
    file.expect("freq_shift", {0});
    file.expect("downsample_padding", {1});
    file.expect("mid_block_scale_factor", {1});
    file.expect("only_cross_attention", {false, nlohmann::json(std::vector<bool>(levels, false))});
    file.expect("resnet_time_scale_shift", {"default"});
    for (auto const* option :
         {"encoder_hid_dim", "encoder_hid_dim_type", "class_embed_type", "addition_embed_type", "num_class_embeds"}) {
        file.expect(option, {nullptr});
    }
    // Names and versions; a precision that is ours anyway; what embeddings that are refused above would have used.
    file.ignore({"_diffusers_version", "_name_or_path", "upcast_attention", "addition_time_embed_dim",
                 "addition_embed_type_num_heads", "projection_class_embeddings_input_dim"});
}

/// Takes the options of the UNet's config.json.
inline void read_unet_options(unet_config& config, config_file& file) {
    file.expect("_class_name", {"UNet2DConditionModel"});
    // What is published under the same class and is another architecture.
    file.require(file["addition_embed_type"] != "text_time", "addition_embed_type",
                 "null (Stable Diffusion 1.x or 2.x; this is Stable Diffusion XL)");
    file.require(file["time_cond_proj_dim"].is_null(), "time_cond_proj_dim",
                 "null (this is a latent consistency model, LCM)");
    file.require(file["in_channels"] != 9 || file["out_channels"] == 9, "in_channels", "4 (this is for inpainting)");
    read_encoder_options(config, file);
    config.out_channels = file.count("out_channels", 4);
    file.require(config.in_channels == config.out_channels, "in_channels",
                 "the " + std::to_string(config.out_channels) + " of out_channels (the network sees latents alone)");
    auto const types =
        file.texts("up_block_types", {plain_up, cross_attention_up, cross_attention_up, cross_attention_up});
    file.require(types.size() == config.levels(), "up_block_types", std::to_string(config.levels()) + " names");
    for (auto const& type : types) {
        file.require(type == cross_attention_up || type == plain_up, "up_block_types",
                     std::string(cross_attention_up) + " or " + plain_up + " for each level");
        config.level_has_attention_up.insert(config.level_has_attention_up.begin(), type == cross_attention_up);
    }
    if (config.level_has_attention_up == config.level_has_attention) {
        config.level_has_attention_up.clear();
    }

    file.expect("num_attention_heads", {nullptr}); // diffusers refuses it too: attention_head_dim is that number
    file.expect("center_input_sample", {false});
    file.expect("dual_cross_attention", {false});
    file.expect("resnet_skip_time_act", {false});
    file.expect("resnet_out_scale_factor", {1});
    file.expect("time_embedding_type", {"positional"});
    file.expect("time_embedding_dim", {nullptr, config.time_channels()});
    file.expect("conv_in_kernel", {3});
    file.expect("conv_out_kernel", {3});
    file.expect("attention_type", {"default"});
    file.expect("class_embeddings_concat", {false});
    file.expect("mid_block_only_cross_attention", {nullptr, false});
    for (auto const* option : {"reverse_transformer_layers_per_block", "time_embedding_act_fn", "timestep_post_act",
                               "time_cond_proj_dim", "cross_attention_norm"}) {
        file.expect(option, {nullptr});
    }
    // The size of pictures in training, and what is dropped in training.
    file.ignore({"sample_size", "dropout"});
    file.require_all_taken();
}

/// Takes the options of the ControlNet's config.json, which must agree with those of the UNet.
inline void read_controlnet_options(unet_config& config, config_file& file, config_file const& unet_file) {
    file.expect("_class_name", {"ControlNetModel"});
    unet_config control;
    read_encoder_options(control, file);
    if (!file["num_attention_heads"].is_null()) {
        control.attention_head_dim = file.count_a_level("num_attention_heads", control.levels(), 0);
    }
    file.ignore({"num_attention_heads"});
    auto const require_same = [&](bool is_same, char const* option) {
        auto const& value = unet_file[option];
        file.require(is_same, option, (value.is_null() ? "the default" : value.dump()) + ", as in " + unet_file.path());
    };
    require_same(control.in_channels == config.in_channels, "in_channels");
    require_same(control.block_out_channels == config.block_out_channels, "block_out_channels");
    require_same(control.level_has_attention == config.level_has_attention, "down_block_types");
    require_same(control.layers_per_block == config.layers_per_block, "layers_per_block");
    require_same(control.attention_head_dim == config.attention_head_dim, "attention_head_dim");
    require_same(control.transformer_layers_per_block == config.transformer_layers_per_block,
                 "transformer_layers_per_block");
    require_same(control.use_linear_projection == config.use_linear_projection, "use_linear_projection");
    require_same(control.cross_attention_dim == config.cross_attention_dim, "cross_attention_dim");
    require_same(control.norm_num_groups == config.norm_num_groups, "norm_num_groups");

    config.conditioning_channels = file.count("conditioning_channels", 3);
    config.conditioning_embedding_out_channels = file.counts("conditioning_embedding_out_channels", {16, 32, 96, 256});
    file.expect("controlnet_conditioning_channel_order", {"rgb"});
    file.expect("global_pool_conditions", {false});
    file.require_all_taken();
}

inline constexpr std::array<std::string_view, 3> prediction_names{"epsilon", "v_prediction", "sample"};
inline constexpr std::array predictions{prediction::epsilon, prediction::velocity, prediction::clean};

/// Takes what scheduler_config.json says of the training. Its other options are about sampling, which is ours.
inline void read_scheduler_options(unet_config& config, config_file& file) {
    auto const kind = file.text("prediction_type", "epsilon");
    auto const found = std::find(prediction_names.begin(), prediction_names.end(), kind);
    file.require(found != prediction_names.end(), "prediction_type", "epsilon, v_prediction or sample");
    config.prediction_type = predictions[static_cast<std::size_t>(found - prediction_names.begin())];
    file.require(file.text("beta_schedule", "linear") == "scaled_linear", "beta_schedule", "\"scaled_linear\"");
    config.num_train_timesteps = file.count("num_train_timesteps", 1000);
    config.beta_start = file.number("beta_start", 0.0001);
    config.beta_end = file.number("beta_end", 0.02);
    file.require(config.num_train_timesteps >= 2, "num_train_timesteps", "at least 2");
    file.require(config.beta_start > 0 && config.beta_start < 1, "beta_start", "a number in (0, 1)");
    file.require(config.beta_end >= config.beta_start && config.beta_end < 1, "beta_end",
                 "a number in [beta_start, 1)");
    file.expect("trained_betas", {nullptr});
    file.expect("rescale_betas_zero_snr", {false});
    file.expect("use_flow_sigmas", {false});
}

/// The options that UNet and ControlNet share.
inline nlohmann::json encoder_json(unet_config const& config) {
    auto types = nlohmann::json::array();
    for (auto const has_attention : config.level_has_attention) {
        types.push_back(has_attention ? cross_attention_down : plain_down);
    }
    return {{"in_channels", config.in_channels},
            {"block_out_channels", config.block_out_channels},
            {"down_block_types", types},
            {"layers_per_block", config.layers_per_block},
            {"attention_head_dim", config.attention_head_dim},
            {"transformer_layers_per_block", config.transformer_layers_per_block},
            {"use_linear_projection", config.use_linear_projection},
            {"cross_attention_dim", config.cross_attention_dim},
            {"norm_num_groups", config.norm_num_groups}};
}

} // namespace internal

/// The architecture in the options of a UNet, of its ControlNet and of their scheduler. Throws file_error naming the
/// option: one that is unknown, has a value that the networks here cannot follow, or differs between UNet and
/// ControlNet; value_error as require_config does.
inline unet_config read_diffusers_config(config_file unet, config_file controlnet, config_file scheduler) {
    unet_config config;
    internal::read_unet_options(config, unet);
    internal::read_controlnet_options(config, controlnet, unet);
    internal::read_scheduler_options(config, scheduler);
    require_config(config);
    return config;
}

/// The same of files: config.json of UNet and ControlNet, scheduler_config.json.
inline unet_config read_diffusers_config(std::filesystem::path const& unet, std::filesystem::path const& controlnet,
                                         std::filesystem::path const& scheduler) {
    // In this order: the first that cannot be read is named.
    config_file unet_file(unet);
    config_file controlnet_file(controlnet);
    return read_diffusers_config(std::move(unet_file), std::move(controlnet_file), config_file(scheduler));
}

/// The config.json of a UNet: the options that are not diffusers' only choice.
inline nlohmann::json unet_json(unet_config const& config) {
    auto json = internal::encoder_json(config);
    json["_class_name"] = "UNet2DConditionModel";
    json["out_channels"] = config.out_channels;
    auto& types = json["up_block_types"] = nlohmann::json::array();
    for (std::size_t level = config.levels(); level-- > 0;) {
        types.push_back(config.has_attention_up(level) ? internal::cross_attention_up : internal::plain_up);
    }
    return json;
}

/// The config.json of the ControlNet beside it.
inline nlohmann::json controlnet_json(unet_config const& config) {
    auto json = internal::encoder_json(config);
    json["_class_name"] = "ControlNetModel";
    json["conditioning_channels"] = config.conditioning_channels;
    json["conditioning_embedding_out_channels"] = config.conditioning_embedding_out_channels;
    return json;
}

/// The scheduler_config.json of their training. Throws value_error for prediction::flow, which has another schedule.
inline nlohmann::json scheduler_json(unet_config const& config) {
    auto const kind = std::find(internal::predictions.begin(), internal::predictions.end(), config.prediction_type);
    require_value(kind != internal::predictions.end(), "scheduler_json", "prediction_type", "flow",
                  "epsilon, velocity or clean");
    return {{"_class_name", "EulerDiscreteScheduler"},
            {"beta_schedule", "scaled_linear"},
            {"beta_start", config.beta_start},
            {"beta_end", config.beta_end},
            {"num_train_timesteps", config.num_train_timesteps},
            {"prediction_type",
             internal::prediction_names[static_cast<std::size_t>(kind - internal::predictions.begin())]}};
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
