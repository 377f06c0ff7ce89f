// SPDX-License-Identifier: MIT
// All that makes a network: its architecture and the parameters of UNet, ControlNet and prompt table.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/diffusers_folder.hpp>
#include <genrender/reference/network_conditioning.hpp>
#include <genrender/reference/prompt_vocabulary.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/safetensors_weights.hpp>
#include <genrender/reference/unet_config.hpp>
#include <genrender/reference/weights.hpp>

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace genrender::reference {

/// The weights of the networks and what is needed to build them.
template <std::floating_point Real>
struct reference_weights {
    unet_config config;                                ///< what both networks are built from
    weights<Real> unet;                                ///< of the denoising network
    weights<Real> controlnet;                          ///< of the ControlNet
    std::optional<prompt_vocabulary<Real>> vocabulary; ///< none if the text encoder is not of this kind

    /// Random weights of any architecture, the same for the same seed; words are prompt_words.
    static reference_weights seeded(std::uint64_t seed, unet_config config = {}) {
        auto prompt = weights<Real>::seeded(seed, "prompt");
        prompt_vocabulary<Real> vocabulary(prompt, config.cross_attention_dim);
        return {std::move(config), weights<Real>::seeded(seed, "unet"), weights<Real>::seeded(seed, "controlnet"),
                std::move(vocabulary)};
    }

    /// A folder in diffusers' layout (see diffusers_folder), the ControlNet in one of its own if that is named. Throws
    /// file_error naming the file, the option or the tensor at fault.
    static reference_weights from_folder(std::filesystem::path const& folder,
                                         std::filesystem::path const& controlnet_folder = {}) {
        diffusers_folder const files(folder, controlnet_folder);
        auto config = files.config();
        auto vocabulary = files.vocabulary<Real>(config.cross_attention_dim);
        return {std::move(config), files.unet<Real>(), files.controlnet<Real>(), std::move(vocabulary)};
    }

    /// What the network is told: inverse depth [frames, height, width] in [0, 1] and a text of the vocabulary's words.
    /// Throws value_error as hint_of and prompt_rows do, and if there is no vocabulary.
    network_conditioning<Real> conditioning(strided_view<float const, 3> inverse_depth, std::string_view text,
                                            Real guidance_scale = 2) const {
        require_value(vocabulary.has_value(), "reference_weights", "text encoder", "none or of another class",
                      "a PromptVocabulary (or a network_conditioning with tokens of your own)");
        return {hint_of<Real>(config, inverse_depth), (*vocabulary)(text), (*vocabulary)(""), guidance_scale};
    }

    /// Writes a folder for from_folder, and for diffusers, with every tensor that networks took so far. Throws
    /// file_error if a file cannot be written, value_error as scheduler_json does.
    void save(std::filesystem::path const& folder, safetensors_storage storage = safetensors_storage::f32) const {
        write_json(folder / "scheduler", "scheduler_config.json", scheduler_json(config));
        write_json(folder / "unet", "config.json", unet_json(config));
        write_weights((folder / "unet" / "diffusion_pytorch_model.safetensors").string(), unet, storage);
        write_json(folder / "controlnet", "config.json", controlnet_json(config));
        write_weights((folder / "controlnet" / "diffusion_pytorch_model.safetensors").string(), controlnet, storage);
        if (vocabulary) {
            auto const table = vocabulary->table();
            write_json(folder / "text_encoder", "config.json",
                       {{"_class_name", "PromptVocabulary"},
                        {"words", vocabulary->words()},
                        {"hidden_size", table.extent(1)}});
            std::vector<float> values;
            for (std::size_t row = 0; row < table.extent(0); ++row) {
                for (auto const value : table[row].row()) {
                    values.push_back(static_cast<float>(value));
                }
            }
            write_safetensors((folder / "text_encoder" / "model.safetensors").string(),
                              {{"token_embedding.weight", {{table.extent(0), table.extent(1)}, values}}}, storage);
        }
    }

private:
    static void write_json(std::filesystem::path const& folder, char const* name, nlohmann::json const& json) {
        // Whatever keeps the folder from being made shows when the file is opened.
        std::error_code ignored;
        std::filesystem::create_directories(folder, ignored);
        std::ofstream file(folder / name);
        file << json.dump(2) << std::endl;
        if (!file) {
            throw file_error((folder / name).string() + ": file cannot be written, expected a writable place");
        }
    }
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
