// SPDX-License-Identifier: MIT
// The weights and inputs of the golden cases, made here as data/golden_data.py makes them.
#pragma once

#include "golden_case.hpp"
#include "small_networks.hpp"

#include <genrender/core/stack.hpp>
#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/diffusers_config.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/unet.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace genrender::testing {

using namespace genrender::reference;

/// Numbers in [-1, 1): the scrambled sum (Steele et al. 2014, splitmix64) of a hash of the name and the index.
inline std::vector<float> golden_values(std::string const& name, std::size_t count) {
    std::uint64_t begin = 0xCBF29CE484222325U;
    for (auto const letter : name) {
        begin = (begin ^ static_cast<unsigned char>(letter)) * 0x100000001B3U;
    }
    std::vector<float> values(count);
    auto* const value = values.data(); // Millions of them are made where nothing is optimised.
    for (std::size_t i = 0; i < count; ++i) {
        auto x = begin + i * 0x9E3779B97F4A7C15U;
        x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
        x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
        x ^= x >> 31;
        value[i] = static_cast<float>(x >> 40) * 0x1p-23f - 1;
    }
    return values;
}

template <class Real, std::size_t Rank>
stack<Real, Rank> golden_stack(std::string const& name, std::array<std::size_t, Rank> const& extents) {
    stack<Real, Rank> result(extents);
    auto const values = golden_values(name, result.size());
    std::copy(values.begin(), values.end(), result.data());
    return result;
}

/// Largest difference of an output [channels, height, width], or of as many numbers in that order, from what another
/// project computed, as a share of its range.
template <class Real>
double difference_share(std::vector<Real> const& found, golden_output const& golden) {
    auto const& expected = std::is_same_v<Real, float> ? golden.single : golden.precise;
    double largest = 0;
    for (std::size_t n = 0; n < expected.size(); ++n) {
        largest = std::max(largest, std::abs(static_cast<double>(found.at(n * golden.step)) - expected[n]));
    }
    return largest / golden.range;
}

/// Names and values of tensors with a `prefix` before their names, as golden_data.py's fill sets them.
inline std::map<std::string, std::vector<float>>
golden_tensors(std::map<std::string, std::vector<std::size_t>> const& shapes, std::string const& prefix) {
    std::map<std::string, std::vector<float>> values;
    for (auto const& [name, shape] : shapes) {
        std::size_t count = 1;
        for (auto const extent : shape) {
            count *= extent;
        }
        auto& x = values[name] = golden_values(prefix + name, count);
        auto const fan_in = static_cast<double>(count / shape[0]);
        auto const scale = static_cast<float>(std::exp2(std::floor(std::log2(std::sqrt(3 / fan_in)))));
        for (auto& value : x) {
            value = shape.size() > 1 ? scale * value : 0.25f * value + (name.ends_with("weight") ? 1.0f : 0.0f);
        }
    }
    return values;
}

/// Writes `folder`/config.json and, beside it, every tensor that the network takes.
template <class Network>
void write_golden_model(std::filesystem::path const& folder, unet_config const& config, std::string const& json,
                        std::string const& prefix) {
    auto shapes = weights<float>::seeded(1, "");
    site_list sites({8, 8});
    Network const network(config, shapes, sites);
    auto const values = golden_tensors(shapes.taken(), prefix);
    std::map<std::string, safetensors_source> sources;
    for (auto const& [name, shape] : shapes.taken()) {
        sources[name] = {shape, values.at(name)};
    }
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "config.json") << json;
    write_safetensors((folder / "diffusion_pytorch_model.safetensors").string(), sources);
}

/// Writes the networks of a case in diffusers' layout; `config` must be the one that its texts describe.
inline void write_golden_folder(std::filesystem::path const& folder, golden_case const& golden,
                                unet_config const& config) {
    auto const& name = golden.name;
    write_golden_model<unet<float>>(folder / "unet", config, golden.unet_json, name + ".unet.");
    write_golden_model<controlnet<float>>(folder / "controlnet", config, golden.controlnet_json, name + ".controlnet.");
    std::filesystem::create_directories(folder / "scheduler");
    std::ofstream(folder / "scheduler" / "scheduler_config.json") << scheduler_json(config);
}

/// The configuration of each case as it is written in C++, in the order of golden_cases().
inline std::array<unet_config, 4> golden_configs() {
    unet_config tiny;
    tiny.in_channels = tiny.out_channels = 12;
    tiny.block_out_channels = {32, 64, 56};
    tiny.level_has_attention = {false, true, false};
    tiny.layers_per_block = 1;
    tiny.attention_head_dim = {1, 2, 2};
    tiny.cross_attention_dim = 48;
    tiny.norm_num_groups = 8;
    tiny.conditioning_channels = 4;
    tiny.conditioning_embedding_out_channels = {32};
    tiny.prediction_type = prediction::velocity;

    unet_config small_sd15;
    small_sd15.in_channels = small_sd15.out_channels = 4;
    small_sd15.block_out_channels = {16, 24, 32, 32};
    small_sd15.level_has_attention = {true, true, true, false};
    small_sd15.layers_per_block = 2;
    small_sd15.attention_head_dim = {8, 8, 8, 8};
    small_sd15.cross_attention_dim = 20;
    small_sd15.norm_num_groups = 8;
    small_sd15.conditioning_channels = 3;
    small_sd15.conditioning_embedding_out_channels = {4, 6, 8, 12};
    small_sd15.prediction_type = prediction::epsilon;

    unet_config small_sd2;
    small_sd2.in_channels = small_sd2.out_channels = 4;
    small_sd2.block_out_channels = {8, 12, 16};
    small_sd2.level_has_attention = {true, true, false};
    small_sd2.layers_per_block = 2;
    small_sd2.attention_head_dim = {2, 3, 4};
    small_sd2.transformer_layers_per_block = 2;
    small_sd2.use_linear_projection = true;
    small_sd2.cross_attention_dim = 6;
    small_sd2.norm_num_groups = 4;
    small_sd2.conditioning_channels = 3;
    small_sd2.conditioning_embedding_out_channels = {4, 6};
    small_sd2.prediction_type = prediction::velocity;

    unet_config uneven;
    uneven.in_channels = uneven.out_channels = 4;
    uneven.block_out_channels = {8, 12};
    uneven.level_has_attention = {false, true};
    uneven.level_has_attention_up = {true, false};
    uneven.layers_per_block = 1;
    uneven.attention_head_dim = {1, 3};
    uneven.cross_attention_dim = 6;
    uneven.norm_num_groups = 4;
    uneven.conditioning_channels = 3;
    uneven.conditioning_embedding_out_channels = {2, 4};
    uneven.prediction_type = prediction::velocity;
    return {tiny, small_sd15, small_sd2, uneven};
}

} // namespace genrender::testing
