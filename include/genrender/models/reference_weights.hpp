// SPDX-License-Identifier: MIT
// All parameters of the reference network: UNet, ControlNet and prompt table, in one safetensors file or from one seed.
#pragma once

#include <genrender/models/network_conditioning.hpp>
#include <genrender/models/prompt_vocabulary.hpp>
#include <genrender/models/unet_config.hpp>
#include <genrender/models/weights.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender {

/// The weights of the three networks. In a file their tensors are named `unet.`, `controlnet.` and `prompt.` before the
/// names that diffusers gives them.
template <std::floating_point Real>
struct reference_weights {
    weights<Real> unet;
    weights<Real> controlnet;
    weights<Real> prompt;

    /// Random weights, the same for the same seed.
    static reference_weights seeded(std::uint64_t seed) {
        return {weights<Real>::seeded(seed, "unet"), weights<Real>::seeded(seed, "controlnet"),
                weights<Real>::seeded(seed, "prompt")};
    }

    /// The weights of a file. Throws file_error as safetensors_file does, and for a tensor of none of the three
    /// networks.
    static reference_weights from_file(std::string const& path) {
        safetensors_file const file(path);
        for (auto const& [name, entry] : file.entries()) {
            if (!name.starts_with("unet.") && !name.starts_with("controlnet.") && !name.starts_with("prompt.")) {
                throw file_error(path + ": tensor " + name +
                                 " belongs to no network, expected names that begin with unet., "
                                 "controlnet. or prompt.");
            }
        }
        return {weights<Real>::from_file(path, "unet."), weights<Real>::from_file(path, "controlnet."),
                weights<Real>::from_file(path, "prompt.")};
    }

    /// What the network is told: inverse depth [frames, height, width] in [0, 1] and a text of prompt_words. Throws
    /// value_error as depth_hint and prompt_rows do, file_error if the prompt table is missing or misshapen.
    network_conditioning<Real> conditioning(unet_config const& config, strided_view<float const, 3> inverse_depth,
                                            std::string_view text, Real guidance_scale = 2) {
        prompt_vocabulary<Real> const vocabulary(prompt, config.cross_attention_dim);
        return {depth_hint<Real>(inverse_depth, config.conditioning_channels), vocabulary(text), vocabulary(""),
                guidance_scale};
    }

    /// Writes every tensor that networks took so far, for from_file. Throws file_error if the file cannot be written.
    void save(std::string const& path, safetensors_storage storage = safetensors_storage::f32) const {
        std::map<std::string, std::vector<float>> values;
        std::map<std::string, safetensors_source> sources;
        for (auto const& [prefix, network] :
             {std::pair("unet.", &unet), std::pair("controlnet.", &controlnet), std::pair("prompt.", &prompt)}) {
            for (auto& [name, elements] : network->values()) {
                auto const& kept = values[prefix + name] = elements;
                sources[prefix + name] = {network->taken().at(name), kept};
            }
        }
        write_safetensors(path, sources, storage);
    }
};

} // namespace genrender
