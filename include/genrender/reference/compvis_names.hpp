// SPDX-License-Identifier: MIT
// The names of tensors in single-file checkpoints, as CompVis' code has them, in those of diffusers and transformers.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/model_part.hpp>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

// CompVis numbers the layers of the UNet's ways down and up through all levels, diffusers numbers them a level; the VAE's
// decoder counts its levels from the other end. SD 2.x has OpenCLIP's text encoder, in which the matrices of queries,
// keys and values are rows of one tensor.

namespace genrender::reference {

/// What a checkpoint's names alone do not say.
struct compvis_layout {
    std::size_t unet_layers = 2; ///< resnets a level on the UNet's way down
    std::size_t vae_levels = 4;  ///< resolutions of the VAE
};

/// A tensor in diffusers' names, as it lies in one of a checkpoint.
struct renamed_tensor {
    std::string name;       ///< diffusers'
    std::size_t part = 0;   ///< which of `parts` equal parts of the stored tensor's rows it is
    std::size_t parts = 1;  ///< how many there are
    bool is_matrix = false; ///< a stored 1x1 kernel [out, in, 1, 1] is its matrix [out, in]
};

/// A stored tensor's network and what it holds of it.
struct renamed_tensors {
    model_part part;                     ///< which network
    std::vector<renamed_tensor> tensors; ///< one, or the three of attention
};

namespace internal {

/// A beginning of names and what stands for it.
struct name_rule {
    std::string_view from;
    std::string_view to;
};

/// The name with its beginning replaced, if a rule fits.
inline std::optional<std::string> renamed(std::string_view name, std::span<name_rule const> rules) {
    for (auto const& [from, to] : rules) {
        if (name.starts_with(from)) {
            return std::string(to) + std::string(name.substr(from.size()));
        }
    }
    return std::nullopt;
}

/// Takes `12.` off the beginning of a name and gives 12, or nothing if it begins otherwise.
inline std::optional<std::size_t> take_number(std::string_view& name) {
    std::size_t number = 0;
    auto const [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    auto const digits = static_cast<std::size_t>(end - name.data());
    if (error != std::errc() || digits == 0 || digits > 3 || digits == name.size() || *end != '.') {
        return std::nullopt;
    }
    name.remove_prefix(digits + 1);
    return number;
}

/// Takes `prefix` off the beginning of a name.
inline bool take_prefix(std::string_view& name, std::string_view prefix) {
    auto const has = name.starts_with(prefix);
    name.remove_prefix(has ? prefix.size() : 0);
    return has;
}

inline constexpr name_rule resnet_rules[] = {
    {"in_layers.0.", "norm1."},  {"in_layers.2.", "conv1."},          {"out_layers.0.", "norm2."},
    {"out_layers.3.", "conv2."}, {"emb_layers.1.", "time_emb_proj."}, {"skip_connection.", "conv_shortcut."}};

inline constexpr name_rule attention_rules[] = {{"norm.", "norm."},
                                                {"proj_in.", "proj_in."},
                                                {"proj_out.", "proj_out."},
                                                {"transformer_blocks.", "transformer_blocks."}};

inline constexpr name_rule unet_rules[] = {{"time_embed.0.", "time_embedding.linear_1."},
                                           {"time_embed.2.", "time_embedding.linear_2."},
                                           {"input_blocks.0.0.", "conv_in."},
                                           {"out.0.", "conv_norm_out."},
                                           {"out.2.", "conv_out."}};

inline constexpr name_rule hint_rules[] = {{"input_hint_block.0.", "controlnet_cond_embedding.conv_in."},
                                           {"input_hint_block.2.", "controlnet_cond_embedding.blocks.0."},
                                           {"input_hint_block.4.", "controlnet_cond_embedding.blocks.1."},
                                           {"input_hint_block.6.", "controlnet_cond_embedding.blocks.2."},
                                           {"input_hint_block.8.", "controlnet_cond_embedding.blocks.3."},
                                           {"input_hint_block.10.", "controlnet_cond_embedding.blocks.4."},
                                           {"input_hint_block.12.", "controlnet_cond_embedding.blocks.5."},
                                           {"input_hint_block.14.", "controlnet_cond_embedding.conv_out."},
                                           {"middle_block_out.0.", "controlnet_mid_block."}};

inline constexpr name_rule vae_rules[] = {{"norm_out.", "conv_norm_out."},
                                          {"mid.block_1.", "mid_block.resnets.0."},
                                          {"mid.block_2.", "mid_block.resnets.1."},
                                          {"mid.attn_1.norm.", "mid_block.attentions.0.group_norm."},
                                          {"mid.attn_1.q.", "mid_block.attentions.0.to_q."},
                                          {"mid.attn_1.k.", "mid_block.attentions.0.to_k."},
                                          {"mid.attn_1.v.", "mid_block.attentions.0.to_v."},
                                          {"mid.attn_1.proj_out.", "mid_block.attentions.0.to_out.0."},
                                          {"conv_in.", "conv_in."},
                                          {"conv_out.", "conv_out."}};

inline constexpr name_rule open_clip_rules[] = {
    {"positional_embedding", "text_model.embeddings.position_embedding.weight"},
    {"token_embedding.", "text_model.embeddings.token_embedding."},
    {"ln_final.", "text_model.final_layer_norm."}};

inline constexpr name_rule open_clip_layer_rules[] = {{"ln_1.", "layer_norm1."},
                                                      {"ln_2.", "layer_norm2."},
                                                      {"mlp.c_fc.", "mlp.fc1."},
                                                      {"mlp.c_proj.", "mlp.fc2."},
                                                      {"attn.out_proj.", "self_attn.out_proj."}};

/// `head` before what the rules make of `name`.
inline std::optional<std::string> renamed_below(std::string const& head, std::string_view name,
                                                std::span<name_rule const> rules) {
    auto rest = renamed(name, rules);
    return rest ? std::optional(head + *rest) : std::nullopt;
}

/// A layer of the UNet by its number on the way down or up, `per_block` of them a level.
inline std::optional<std::string> unet_layer_name(std::string_view name, char const* way, std::size_t layer,
                                                  std::size_t per_block, bool goes_down) {
    auto const block = std::string(way) + std::to_string(layer / per_block) + ".";
    auto const number = std::to_string(layer % per_block) + ".";
    auto const is_last = layer % per_block == per_block - 1;
    if (goes_down && is_last) {
        return take_prefix(name, "0.op.") ? std::optional(block + "downsamplers.0.conv." + std::string(name))
                                          : std::nullopt;
    }
    if (take_prefix(name, "0.")) {
        return renamed_below(block + "resnets." + number, name, resnet_rules);
    }
    if (!goes_down && is_last && (take_prefix(name, "1.conv.") || take_prefix(name, "2.conv."))) {
        return block + "upsamplers.0.conv." + std::string(name);
    }
    return take_prefix(name, "1.") ? renamed_below(block + "attentions." + number, name, attention_rules)
                                   : std::nullopt;
}

/// A tensor of the UNet or, with `is_control`, of the ControlNet.
inline std::optional<std::string> unet_name(std::string_view name, std::size_t layers, bool is_control) {
    if (auto whole = renamed(name, unet_rules)) {
        return is_control && name.starts_with("out.") ? std::nullopt : whole;
    }
    if (take_prefix(name, "input_blocks.")) {
        auto const number = take_number(name);
        return number && *number > 0 ? unet_layer_name(name, "down_blocks.", *number - 1, layers + 1, true)
                                     : std::nullopt;
    }
    if (!is_control && take_prefix(name, "output_blocks.")) {
        auto const number = take_number(name);
        return number ? unet_layer_name(name, "up_blocks.", *number, layers + 1, false) : std::nullopt;
    }
    if (take_prefix(name, "middle_block.")) {
        return take_prefix(name, "0.")   ? renamed_below("mid_block.resnets.0.", name, resnet_rules)
               : take_prefix(name, "1.") ? renamed_below("mid_block.attentions.0.", name, attention_rules)
               : take_prefix(name, "2.") ? renamed_below("mid_block.resnets.1.", name, resnet_rules)
                                         : std::nullopt;
    }
    if (is_control && take_prefix(name, "zero_convs.")) {
        auto const number = take_number(name);
        return number && take_prefix(name, "0.")
                   ? std::optional("controlnet_down_blocks." + std::to_string(*number) + "." + std::string(name))
                   : std::nullopt;
    }
    return is_control ? renamed(name, hint_rules) : std::nullopt;
}

/// A tensor of the VAE.
inline std::optional<renamed_tensor> vae_name(std::string_view name, std::size_t levels) {
    if (name.starts_with("quant_conv.") || name.starts_with("post_quant_conv.")) {
        return renamed_tensor{std::string(name)};
    }
    auto const head = std::string(name.substr(0, name.find('.') + 1));
    auto const is_decoder = head == "decoder.";
    if (!is_decoder && head != "encoder.") {
        return std::nullopt;
    }
    name.remove_prefix(head.size());
    if (auto whole = renamed_below(head, name, vae_rules)) {
        auto const is_attention = name.starts_with("mid.attn_1.") && !name.starts_with("mid.attn_1.norm.");
        return renamed_tensor{std::move(*whole), 0, 1, is_attention && name.ends_with(".weight")};
    }
    auto const level = take_prefix(name, is_decoder ? "up." : "down.") ? take_number(name) : std::nullopt;
    if (!level || *level >= levels) {
        return std::nullopt;
    }
    auto const block = head + (is_decoder ? "up_blocks." : "down_blocks.") +
                       std::to_string(is_decoder ? levels - 1 - *level : *level) + ".";
    if (take_prefix(name, is_decoder ? "upsample." : "downsample.")) {
        return renamed_tensor{block + (is_decoder ? "upsamplers.0." : "downsamplers.0.") + std::string(name)};
    }
    auto const layer = take_prefix(name, "block.") ? take_number(name) : std::nullopt;
    if (!layer) {
        return std::nullopt;
    }
    auto const is_shortcut = take_prefix(name, "nin_shortcut.");
    return renamed_tensor{block + "resnets." + std::to_string(*layer) + (is_shortcut ? ".conv_shortcut." : ".") +
                          std::string(name)};
}

/// Tensors of OpenCLIP's text encoder; none if the name is not one.
inline std::vector<renamed_tensor> open_clip_names(std::string_view name) {
    if (auto whole = renamed(name, open_clip_rules)) {
        return {{std::move(*whole)}};
    }
    auto const layer = take_prefix(name, "transformer.resblocks.") ? take_number(name) : std::nullopt;
    if (!layer) {
        return {};
    }
    auto const head = "text_model.encoder.layers." + std::to_string(*layer) + ".";
    if (take_prefix(name, "attn.in_proj_") && (name == "weight" || name == "bias")) {
        auto const of = [&](char const* which) { return head + "self_attn." + which + "_proj." + std::string(name); };
        return {{of("q"), 0, 3}, {of("k"), 1, 3}, {of("v"), 2, 3}};
    }
    auto rest = renamed_below(head, name, open_clip_layer_rules);
    return rest ? std::vector{renamed_tensor{std::move(*rest)}} : std::vector<renamed_tensor>{};
}

} // namespace internal

/// What diffusers and transformers call a tensor of a checkpoint of Stable Diffusion 1.x or 2.x or of a ControlNet, or
/// nothing if it is none of those.
inline std::optional<renamed_tensors> diffusers_names(std::string_view name, compvis_layout const& layout = {}) {
    auto const one = [](model_part part, std::optional<std::string> renamed) -> std::optional<renamed_tensors> {
        return renamed ? std::optional(renamed_tensors{part, {{std::move(*renamed)}}}) : std::nullopt;
    };
    if (internal::take_prefix(name, "model.diffusion_model.")) {
        return one(model_part::unet, internal::unet_name(name, layout.unet_layers, false));
    }
    if (internal::take_prefix(name, "control_model.")) {
        return one(model_part::controlnet, internal::unet_name(name, layout.unet_layers, true));
    }
    if (internal::take_prefix(name, "first_stage_model.")) {
        auto renamed = internal::vae_name(name, layout.vae_levels);
        return renamed ? std::optional(renamed_tensors{model_part::vae, {std::move(*renamed)}}) : std::nullopt;
    }
    if (internal::take_prefix(name, "cond_stage_model.model.")) {
        auto tensors = internal::open_clip_names(name);
        return tensors.empty() ? std::nullopt
                               : std::optional(renamed_tensors{model_part::text_encoder, std::move(tensors)});
    }
    if (internal::take_prefix(name, "cond_stage_model.transformer.") && name.starts_with("text_model.")) {
        return renamed_tensors{model_part::text_encoder, {{std::string(name)}}};
    }
    return std::nullopt;
}

/// Whether a tensor of a checkpoint is left over from training, or can be computed, or is of a part that makes no
/// pictures: averages of the weights (`model_ema`), noise schedules, losses, positions, projections for CLIP's score.
inline bool is_training_leftover(std::string_view name) {
    static constexpr std::string_view beginnings[] = {"model_ema.", "first_stage_model.loss.", "posterior_",
                                                      "first_stage_model.model_ema.", "embedding_manager."};
    static constexpr std::string_view names[] = {"betas",
                                                 "alphas_cumprod",
                                                 "alphas_cumprod_prev",
                                                 "sqrt_alphas_cumprod",
                                                 "sqrt_one_minus_alphas_cumprod",
                                                 "log_one_minus_alphas_cumprod",
                                                 "sqrt_recip_alphas_cumprod",
                                                 "sqrt_recipm1_alphas_cumprod",
                                                 "logvar",
                                                 "lvlb_weights",
                                                 "scale_factor",
                                                 "global_step",
                                                 "cond_stage_model.logit_scale",
                                                 "cond_stage_model.text_projection",
                                                 "cond_stage_model.model.attn_mask",
                                                 "cond_stage_model.model.logit_scale",
                                                 "cond_stage_model.model.text_projection"};
    auto const begins = [&](std::string_view beginning) { return name.starts_with(beginning); };
    return name.ends_with(".embeddings.position_ids") || std::ranges::any_of(beginnings, begins) ||
           std::ranges::find(names, name) != std::end(names);
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
