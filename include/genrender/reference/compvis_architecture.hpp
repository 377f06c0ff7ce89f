// SPDX-License-Identifier: MIT
// The architectures of a single-file checkpoint, which says none: inferred from the shapes of its tensors.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/diffusers_config.hpp>
#include <genrender/reference/tensor_place.hpp>
#include <genrender/reference/unet_config.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

// Numbers of groups, heads and the like leave no trace in a tensor. They are those of Stable Diffusion: 32 groups; 8
// heads in 1.x, heads of 64 channels in 2.x and in both text encoders; quick_gelu in CLIP, gelu in OpenCLIP.

namespace genrender::reference {

namespace internal {

/// Shapes of tensors by diffusers' names.
class tensor_shapes {
public:
    tensor_shapes(tensor_places const& places, std::string const& path) : places_(places), path_(path) {}

    bool has(std::string const& name) const { return places_.contains(name); }

    /// One extent. Throws file_error if there is no such tensor or axis, or it is not from 1 to 1000000.
    std::size_t extent(std::string const& name, std::size_t axis) const {
        auto const found = places_.find(name);
        if (found == places_.end()) {
            throw file_error(path_ + ": there is no tensor " + name + ", expected one to infer the architecture from");
        }
        auto const& shape = found->second.shape;
        if (axis >= shape.size() || shape[axis] < 1 || shape[axis] > 1000000) {
            throw file_error(path_ + ": tensor " + name + " is " + extents_text(shape) + ", expected an axis " +
                             std::to_string(axis) + " of 1 to 1000000");
        }
        return shape[axis];
    }

    /// How many numbers from 0 on make a name that exists.
    template <class NameOf>
    std::size_t count(NameOf const& name_of) const {
        std::size_t count = 0;
        while (has(name_of(count))) {
            ++count;
        }
        return count;
    }

private:
    tensor_places const& places_;
    std::string const& path_;
};

inline std::string resnet_convolution(std::string const& block, std::size_t level, std::size_t layer) {
    return block + std::to_string(level) + ".resnets." + std::to_string(layer) + ".conv1.weight";
}

} // namespace internal

/// The architecture of a UNet or a ControlNet in diffusers' names, of its tensors alone. What the network is trained to
/// predict is not in them: it stays epsilon. Throws file_error naming a tensor without which nothing can be inferred.
inline unet_config infer_unet_config(tensor_places const& places, std::string const& path) {
    internal::tensor_shapes const shapes(places, path);
    auto const level_name = [](std::size_t level) { return internal::resnet_convolution("down_blocks.", level, 0); };
    auto const layer_name = [](std::size_t layer) { return internal::resnet_convolution("down_blocks.", 0, layer); };
    unet_config config;
    config.prediction_type = prediction::epsilon;
    config.in_channels = shapes.extent("conv_in.weight", 1);
    config.out_channels = shapes.has("conv_out.weight") ? shapes.extent("conv_out.weight", 0) : config.in_channels;
    config.layers_per_block = std::max<std::size_t>(1, shapes.count(layer_name));
    config.norm_num_groups = 32;
    config.block_out_channels.clear();
    config.level_has_attention.clear();
    auto const levels = std::max<std::size_t>(1, shapes.count(level_name));
    for (std::size_t level = 0; level < levels; ++level) {
        config.block_out_channels.push_back(shapes.extent(level_name(level), 0));
        config.level_has_attention.push_back(
            shapes.has("down_blocks." + std::to_string(level) + ".attentions.0.proj_in.weight"));
    }
    auto const attention = std::string("mid_block.attentions.0.");
    auto const block = [&](std::size_t i) { return attention + "transformer_blocks." + std::to_string(i); };
    config.transformer_layers_per_block =
        std::max<std::size_t>(1, shapes.count([&](std::size_t i) { return block(i) + ".attn2.to_k.weight"; }));
    config.cross_attention_dim = shapes.extent(block(0) + ".attn2.to_k.weight", 1);
    config.use_linear_projection =
        places.contains(attention + "proj_in.weight") && places.at(attention + "proj_in.weight").shape.size() == 2;
    config.attention_head_dim.clear();
    for (auto const channels : config.block_out_channels) {
        auto const is_first_family = config.cross_attention_dim == 768;
        config.attention_head_dim.push_back(is_first_family ? 8 : std::max<std::size_t>(1, channels / 64));
    }
    config.conditioning_channels = 3;
    config.conditioning_embedding_out_channels = {16, 32, 96, 256};
    if (auto const hint = std::string("controlnet_cond_embedding."); shapes.has(hint + "conv_in.weight")) {
        auto const in_name = [&](std::size_t i) { return hint + "blocks." + std::to_string(2 * i + 1) + ".weight"; };
        config.conditioning_channels = shapes.extent(hint + "conv_in.weight", 1);
        config.conditioning_embedding_out_channels = {shapes.extent(hint + "conv_in.weight", 0)};
        for (std::size_t i = 0; shapes.has(in_name(i)); ++i) {
            config.conditioning_embedding_out_channels.push_back(shapes.extent(in_name(i), 0));
        }
    }
    return config;
}

/// The options of an AutoencoderKL in diffusers' names, of its tensors alone. Throws as infer_unet_config does.
inline nlohmann::json infer_vae_options(tensor_places const& places, std::string const& path) {
    internal::tensor_shapes const shapes(places, path);
    auto const block = std::string("encoder.down_blocks.");
    auto const level_name = [&](std::size_t level) { return internal::resnet_convolution(block, level, 0); };
    std::vector<std::size_t> channels;
    for (std::size_t level = 0; shapes.has(level_name(level)); ++level) {
        channels.push_back(shapes.extent(level_name(level), 0));
    }
    return {{"_class_name", "AutoencoderKL"},
            {"in_channels", shapes.extent("encoder.conv_in.weight", 1)},
            {"out_channels", shapes.extent("decoder.conv_out.weight", 0)},
            {"latent_channels", shapes.extent("decoder.conv_in.weight", 1)},
            {"block_out_channels", channels},
            {"down_block_types", std::vector<std::string>(channels.size(), "DownEncoderBlock2D")},
            {"up_block_types", std::vector<std::string>(channels.size(), "UpDecoderBlock2D")},
            {"layers_per_block",
             shapes.count([&](std::size_t layer) { return internal::resnet_convolution(block, 0, layer); })},
            {"norm_num_groups", 32},
            {"act_fn", "silu"},
            {"scaling_factor", 0.18215}};
}

/// The options of a CLIPTextModel in transformers' names, of its tensors alone; `is_open_clip` if it is SD 2.x's.
/// Throws as infer_unet_config does.
inline nlohmann::json infer_text_options(tensor_places const& places, std::string const& path, bool is_open_clip) {
    internal::tensor_shapes const shapes(places, path);
    auto const layer = [](std::size_t i) { return "text_model.encoder.layers." + std::to_string(i); };
    auto const hidden = shapes.extent("text_model.embeddings.token_embedding.weight", 1);
    return {{"architectures", {"CLIPTextModel"}},
            {"model_type", "clip_text_model"},
            {"vocab_size", shapes.extent("text_model.embeddings.token_embedding.weight", 0)},
            {"max_position_embeddings", shapes.extent("text_model.embeddings.position_embedding.weight", 0)},
            {"hidden_size", hidden},
            {"intermediate_size", shapes.extent(layer(0) + ".mlp.fc1.weight", 0)},
            {"num_hidden_layers", shapes.count([&](std::size_t i) { return layer(i) + ".mlp.fc1.weight"; })},
            {"num_attention_heads", std::max<std::size_t>(1, hidden / 64)},
            {"hidden_act", is_open_clip ? "gelu" : "quick_gelu"},
            {"layer_norm_eps", 1e-5}};
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
