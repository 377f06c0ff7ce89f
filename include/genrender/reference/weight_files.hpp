// SPDX-License-Identifier: MIT
// The safetensors files of one network in a folder: whole or in shards, in full precision or as a variant.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/config_file.hpp>
#include <genrender/reference/pickles.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/tensor_place.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace genrender::reference {

namespace internal {

/// The file in each shard of an index, and the tensors that it should hold.
inline std::map<std::string, std::vector<std::string>> shards_of(config_file const& index) {
    auto const& map = index["weight_map"];
    // A shard lies beside the index, wherever that claims it to be.
    auto const is_name = [](nlohmann::json const& value) {
        auto const text = value.is_string() ? value.get<std::string>() : "";
        return !text.empty() && text != "." && text != ".." && text.find_first_of("/\\:") == std::string::npos &&
               text.find('\0') == std::string::npos;
    };
    index.require(map.is_object() && !map.empty() && std::all_of(map.begin(), map.end(), is_name), "weight_map",
                  "an object with the name of a file beside the index for each tensor");
    std::map<std::string, std::vector<std::string>> shards;
    for (auto const& [tensor, shard] : map.items()) {
        shards[shard.get<std::string>()].push_back(tensor);
    }
    return shards;
}

/// The tensors of all shards that an index lists.
inline tensor_places sharded_places(std::filesystem::path const& folder, std::filesystem::path const& index_path) {
    config_file const index(index_path);
    tensor_places places;
    for (auto const& [shard, tensors] : shards_of(index)) {
        auto const path = folder / shard;
        if (!std::filesystem::exists(path)) {
            throw file_error(index.path() + ": shard " + shard + " of " + std::to_string(tensors.size()) +
                             " tensors is not beside it, expected all files of its weight_map");
        }
        refuse_pickle(path);
        auto const file = std::make_shared<safetensors_file const>(path.string());
        counted_names missing;
        for (auto const& tensor : tensors) {
            if (!file->entries().contains(tensor)) {
                missing.add(tensor);
            }
        }
        if (missing.count() > 0) {
            throw file_error(file->path() + ": " + std::to_string(missing.count()) +
                             " tensors are missing that the index has here: " + missing.text() + ", expected all " +
                             std::to_string(tensors.size()));
        }
        add_places(places, places_of(file));
    }
    return places;
}

/// The tensors of one precision of a model, or nothing if there is no file of it.
inline std::optional<tensor_places> places_of_variant(std::filesystem::path const& folder, std::string const& stem,
                                                      std::string const& variant) {
    auto const whole = folder / (stem + (variant.empty() ? "" : "." + variant) + ".safetensors");
    if (std::filesystem::exists(whole)) {
        return places_of(std::make_shared<safetensors_file const>(whole.string()));
    }
    // Where the variant's name stands in an index has changed over the years.
    auto const indices = variant.empty() ? std::vector{stem + ".safetensors.index.json"}
                                         : std::vector{stem + ".safetensors.index." + variant + ".json",
                                                       stem + "." + variant + ".safetensors.index.json"};
    for (auto const& index : indices) {
        if (std::filesystem::exists(folder / index)) {
            return sharded_places(folder, folder / index);
        }
    }
    return std::nullopt;
}

} // namespace internal

/// The tensors of the model `stem` in a folder. Of a `variant`, say `fp16`: those of `stem.fp16.safetensors`, or of the
/// shards that `stem.safetensors.index.fp16.json` lists. Without one: `stem.safetensors`, or its shards, or else the
/// variants fp16 and bf16. Throws file_error if there is none, naming pickles that are there instead and how to convert
/// them; for an index that is none, names files that are not beside it, or tensors that its shards do not hold; for a
/// tensor in two shards; and as safetensors_file does.
inline tensor_places find_weights(std::filesystem::path const& folder, std::string const& stem,
                                  std::string const& variant = {}) {
    auto const variants = variant.empty() ? std::vector<std::string>{"", "fp16", "bf16"} : std::vector{variant};
    for (auto const& one : variants) {
        if (auto places = internal::places_of_variant(folder, stem, one)) {
            return std::move(*places);
        }
    }
    auto const pickles = pickles_in(folder);
    if (!pickles.empty()) {
        throw file_error(pickle_refusal(pickles.front()));
    }
    auto const name = stem + (variant.empty() ? "" : "." + variant) + ".safetensors";
    throw file_error(folder.string() + ": there is no " + name + ", expected one, " +
                     (variant.empty() ? "or its .fp16 or .bf16, " : "") + "or an index of its shards");
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
