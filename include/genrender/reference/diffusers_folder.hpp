// SPDX-License-Identifier: MIT
// A folder of networks in diffusers' layout, as save_pretrained writes it and as models are published.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/config_file.hpp>
#include <genrender/reference/diffusers_config.hpp>
#include <genrender/reference/prompt_vocabulary.hpp>
#include <genrender/reference/unet_config.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// The safetensors files of a model `stem`, one of which must be there: `stem.safetensors`; the shards that
/// `stem.safetensors.index.json` lists; the same of half precision, `stem.fp16...`. Throws file_error if none is, or if
/// the index is not one.
inline std::vector<std::string> safetensors_paths(std::filesystem::path const& folder, std::string const& stem) {
    for (auto const& name : {stem, stem + ".fp16"}) {
        auto const whole = folder / (name + ".safetensors");
        if (std::filesystem::exists(whole)) {
            return {whole.string()};
        }
        // diffusers puts the precision of shards behind the word index.
        auto const index_name = name == stem ? stem + ".safetensors.index.json" : stem + ".safetensors.index.fp16.json";
        if (!std::filesystem::exists(folder / index_name)) {
            continue;
        }
        config_file const index(folder / index_name);
        auto const& map = index["weight_map"];
        // A shard lies beside the index, wherever that claims it to be.
        auto const is_name = [](nlohmann::json const& value) {
            auto const text = value.is_string() ? value.get<std::string>() : "";
            return !text.empty() && text != "." && text != ".." && text.find_first_of("/\\:") == std::string::npos;
        };
        index.require(map.is_object() && !map.empty() && std::all_of(map.begin(), map.end(), is_name), "weight_map",
                      "an object with the name of a file for each tensor");
        std::set<std::string> paths;
        for (auto const& shard : map) {
            paths.insert((folder / shard.get<std::string>()).string());
        }
        return {paths.begin(), paths.end()};
    }
    throw file_error(folder.string() + ": there is no " + stem + ".safetensors, expected one, or its .fp16, or an " +
                     "index of shards");
}

/// The parts of a folder:
///
///     unet/                      config.json, diffusion_pytorch_model.safetensors
///     controlnet/                config.json, diffusion_pytorch_model.safetensors
///     scheduler/                 scheduler_config.json
///     text_encoder/              config.json, model.safetensors
///
/// where the ControlNet may be a folder of its own, and the text encoder one that is known here, a prompt_vocabulary:
/// its config.json is `{"_class_name": "PromptVocabulary", "words": ["stripes", ...], "hidden_size": 48}` and its only
/// tensor `token_embedding.weight` [1 + words, hidden_size].
class diffusers_folder {
public:
    /// Reads no file yet. `controlnet` is by default the folder of that name inside.
    explicit diffusers_folder(std::filesystem::path folder, std::filesystem::path controlnet = {})
        : folder_(std::move(folder)), controlnet_(controlnet.empty() ? folder_ / "controlnet" : std::move(controlnet)) {
    }

    /// The architecture. Throws as read_diffusers_config does.
    unet_config config() const {
        return read_diffusers_config(folder_ / "unet" / "config.json", controlnet_ / "config.json",
                                     folder_ / "scheduler" / "scheduler_config.json");
    }

    /// The UNet's tensors. Throws file_error as safetensors_paths and safetensors_file do.
    template <std::floating_point Real>
    weights<Real> unet() const {
        return weights<Real>::from_files(safetensors_paths(folder_ / "unet", "diffusion_pytorch_model"));
    }

    /// The ControlNet's tensors. Throws file_error as safetensors_paths and safetensors_file do.
    template <std::floating_point Real>
    weights<Real> controlnet() const {
        return weights<Real>::from_files(safetensors_paths(controlnet_, "diffusion_pytorch_model"));
    }

    /// The text encoder, or nothing if there is none or one of another class than PromptVocabulary, whose tokens the
    /// caller must make. Throws file_error if its files do not hold what they should, among them tokens of as many
    /// `channels` as the UNet attends to.
    template <std::floating_point Real>
    std::optional<prompt_vocabulary<Real>> vocabulary(std::size_t channels) const {
        auto const folder = folder_ / "text_encoder";
        if (!std::filesystem::exists(folder / "config.json")) {
            return std::nullopt;
        }
        config_file file(folder / "config.json");
        if (file["_class_name"] != "PromptVocabulary") {
            return std::nullopt;
        }
        auto words = file.texts("words", {});
        for (auto const& word : words) {
            auto const is_fine = internal::is_prompt_word(word) && std::count(words.begin(), words.end(), word) == 1;
            file.require(is_fine, "words", "words of lower-case letters and digits, each once");
        }
        file.require(!words.empty(), "words", "at least one");
        file.require(file.count("hidden_size", 0) == channels, "hidden_size",
                     std::to_string(channels) + ", the UNet's cross_attention_dim");
        file.ignore({"_class_name", "_diffusers_version", "_name_or_path"});
        file.require_all_taken();
        auto source = weights<Real>::from_files(safetensors_paths(folder, "model"));
        return prompt_vocabulary<Real>(source, channels, std::move(words));
    }

private:
    std::filesystem::path folder_;
    std::filesystem::path controlnet_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
