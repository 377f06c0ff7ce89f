// SPDX-License-Identifier: MIT
// Small checkpoints in CompVis' names, written the way back through diffusers' own list of names.
#pragma once

#include "../support/golden_file.hpp"
#include "golden_network.hpp"

#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/unet_config.hpp>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace genrender::testing {

/// Tensors that are to be written.
struct tensor_list {
    std::map<std::string, std::vector<std::size_t>> shapes; ///< by name

    /// One more, or another shape.
    tensor_list& add(std::string const& name, std::vector<std::size_t> const& shape) {
        shapes[name] = shape;
        return *this;
    }
    /// Writes each with golden_values of its name.
    void write(std::string const& path, safetensors_storage storage = safetensors_storage::f32) const {
        std::map<std::string, std::vector<float>> values;
        std::map<std::string, safetensors_source> sources;
        for (auto const& [name, shape] : shapes) {
            std::size_t count = 1;
            for (auto const extent : shape) {
                count *= extent;
            }
            values[name] = golden_values(name, count);
            sources[name] = {shape, values[name]};
        }
        write_safetensors(path, sources, storage);
    }
};

/// What a small Stable Diffusion 1.x (768) or 2.x (1024) is built from: the names of the great one, few channels.
inline unet_config small_checkpoint_config(std::size_t cross_attention_dim) {
    unet_config config;
    config.in_channels = config.out_channels = 4;
    config.block_out_channels = {32, 64, 96, 96};
    config.level_has_attention = {true, true, true, false};
    config.layers_per_block = 2;
    config.attention_head_dim = {8, 8, 8, 8};
    if (cross_attention_dim != 768) {
        config.attention_head_dim = {1, 1, 1, 1};
        config.use_linear_projection = true;
    }
    config.cross_attention_dim = cross_attention_dim;
    config.norm_num_groups = 32;
    config.conditioning_channels = 3;
    config.conditioning_embedding_out_channels = {4, 4, 4, 4};
    config.prediction_type = prediction::epsilon;
    return config;
}

/// The stored name of every tensor of a network (`unet`, `controlnet`, `vae`, `clip`, `open_clip`) by diffusers' name;
/// the fused ones of attention by that of the queries.
inline std::map<std::string, std::string> stored_names(std::string const& network) {
    std::map<std::string, std::string> names;
    auto const golden = golden_file("compvis_names.json");
    for (auto const& pair : golden.at(network).at("pairs")) {
        auto const letters = pair.at(2).get<std::string>();
        auto const change = pair.at(3).get<std::string>();
        for (auto const letter : letters == "whole" ? std::string(" ") : letters) {
            auto const* const suffix = letter == ' ' ? "" : letter == 'b' ? "bias" : "weight";
            if (change.empty() || change == "third 0") {
                names[pair.at(1).get<std::string>() + suffix] = pair.at(0).get<std::string>() + suffix;
            }
        }
    }
    return names;
}

/// The tensors that a network of ours takes, in a checkpoint's names.
template <class Network>
tensor_list stored_network(unet_config const& config, std::string const& network) {
    auto source = weights<float>::listing(5000, network);
    site_list sites({8, 8});
    Network const built(config, source, sites);
    auto const names = stored_names(network);
    tensor_list tensors;
    for (auto const& [name, shape] : source.taken()) {
        tensors.add(names.at(name), shape);
    }
    return tensors;
}

/// The tensors of a VAE of 32 channels everywhere, in a checkpoint's names.
inline tensor_list stored_vae() {
    tensor_list tensors;
    for (auto const& [name, stored] : stored_names("vae")) {
        auto const is_vector = name.ends_with("bias") || name.find("norm") != std::string::npos;
        tensors.add(stored, is_vector ? std::vector<std::size_t>{32} : std::vector<std::size_t>{32, 32, 1, 1});
    }
    return tensors.add("first_stage_model.encoder.conv_in.weight", {32, 3, 3, 3})
        .add("first_stage_model.decoder.conv_in.weight", {32, 4, 3, 3})
        .add("first_stage_model.decoder.conv_out.weight", {3, 32, 3, 3});
}

} // namespace genrender::testing
