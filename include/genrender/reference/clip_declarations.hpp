// SPDX-License-Identifier: MIT
// What the files of a folder `tokenizer/` in diffusers' layout say of special tokens and of a prompt's length.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/byte_pair_files.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// Texts of a tokenizer's files by their names: vocab.json and merges.txt, or tokenizer.json, which counts if both are
/// there; tokenizer_config.json, special_tokens_map.json and added_tokens.json may be absent.
struct clip_tokenizer_files {
    std::filesystem::path folder;             ///< where errors say that the files lie
    std::map<std::string, std::string> texts; ///< by name

    /// Whether there is a file of this name.
    bool has(std::string const& name) const { return texts.contains(name); }
    /// Path of a file of this name.
    std::string path(std::string const& name) const { return (folder / name).string(); }
    /// The JSON object that a file holds, an empty one if it is not there. Throws file_error if it holds something else.
    nlohmann::json object(std::string const& name) const {
        return has(name) ? internal::json_object(texts.at(name), path(name)) : nlohmann::json::object();
    }
};

/// A token as a file declares it: its name alone, or with how it is looked for.
struct clip_declared_token {
    std::string content;            ///< its name, not empty
    bool is_name = true;            ///< whether the file has no more than its name
    bool is_special = true;         ///< whether it has a purpose and is no text
    std::optional<bool> is_cleaned; ///< whether it is looked for in the cleaned text

    /// Whether it is looked for in the cleaned text: as declared, or else if it is not special.
    bool in_cleaned() const { return is_cleaned.value_or(!is_special); }
};

/// The tokens that files declare, and how long a prompt is.
struct clip_declarations {
    std::map<std::size_t, clip_declared_token> numbered; ///< those with an id
    std::map<std::size_t, std::string> places;           ///< where each of these stands: `path: key NAME`
    /// Those with a purpose, nothing where the file says null.
    std::map<std::string, std::optional<clip_declared_token>> named;
    std::vector<clip_declared_token> others; ///< those with neither id nor purpose
    std::size_t context_length = 77;         ///< tokens of a prompt, from 2 to 65536
};

/// Names of the purposes, in the order in which transformers adds their tokens.
inline constexpr std::array<char const*, 7> clip_purposes{"bos_token", "eos_token", "unk_token", "sep_token",
                                                          "pad_token", "cls_token", "mask_token"};

namespace internal {

/// Reads a token, `key` of the file `path`. Tokens that take white space or word boundaries with them are refused.
inline clip_declared_token read_declared_token(nlohmann::json const& value, std::string const& path,
                                               std::string const& key) {
    if (value.is_string()) {
        require_key(!value.get_ref<std::string const&>().empty(), path, key, value, "a name");
        return {value.get<std::string>(), true, true, {}};
    }
    require_key(value.is_object() && value.contains("content"), path, key, value, "a name or an object with content");
    auto const& content = value["content"];
    require_key(content.is_string() && !content.get_ref<std::string const&>().empty(), path, key + ".content", content,
                "a name");
    for (auto const* flag : {"lstrip", "rstrip", "single_word"}) {
        if (value.contains(flag)) {
            require_key(value[flag] == false, path, key + "." + flag, value[flag], "false");
        }
    }
    clip_declared_token token{content.get<std::string>(), false, false, {}};
    for (auto const* flag : {"normalized", "special"}) {
        if (value.contains(flag)) {
            require_key(value[flag].is_boolean(), path, key + "." + flag, value[flag], "true or false");
        }
    }
    token.is_special = value.value("special", false);
    if (value.contains("normalized")) {
        token.is_cleaned = value["normalized"].get<bool>();
    }
    return token;
}

/// Notes a token with an id.
inline void declare_numbered(clip_declarations& found, std::size_t id, clip_declared_token token,
                             std::string const& path, std::string const& key) {
    found.numbered.insert_or_assign(id, std::move(token));
    found.places[id] = path + ": key " + key;
}

/// Reads purposes and tokens without one from the options of a file; what is there already is replaced.
inline void read_purposes(clip_declarations& found, nlohmann::json const& options, std::string const& path,
                          bool all_special) {
    for (auto const& [key, value] : options.items()) {
        auto const is_purpose = std::find(clip_purposes.begin(), clip_purposes.end(), key) != clip_purposes.end();
        if (is_purpose && value.is_null()) {
            found.named[key] = std::nullopt;
        } else if (is_purpose) {
            auto token = read_declared_token(value, path, key);
            token.is_special = token.is_special || all_special;
            found.named[key] = std::move(token);
        } else if (key == "additional_special_tokens" || key == "extra_special_tokens") {
            require_key(value.is_null() || value.is_array() || value.empty(), path, key, value, "a list of tokens");
            for (auto const& entry : value) {
                auto token = read_declared_token(entry, path, key);
                token.is_special = token.is_special || all_special;
                found.others.push_back(std::move(token));
            }
        } else {
            // Any other would become a token of its own.
            require_key(!key.ends_with("_token") || !value.is_string(), path, key, value, "no such key");
        }
    }
}

} // namespace internal

/// Reads what the files say of tokens and of a prompt's length, `tokenizer` being the content of tokenizer.json or empty.
/// Tokens with ids are those of the key added_tokens_decoder of tokenizer_config.json, or else of added_tokens.json and
/// tokenizer.json; in that case special_tokens_map.json counts before tokenizer_config.json. Throws file_error naming the
/// file and the key for what cannot be, or what is not CLIP's tokenizer.
inline clip_declarations read_clip_declarations(clip_tokenizer_files const& files, nlohmann::json const& tokenizer) {
    clip_declarations found;
    std::string const config_name = "tokenizer_config.json";
    auto const path = files.path(config_name);
    auto const config = files.object(config_name);
    auto const expect = [&](char const* key, std::initializer_list<nlohmann::json> values, char const* expected) {
        auto const holds =
            !config.contains(key) || std::find(values.begin(), values.end(), config[key]) != values.end();
        internal::require_key(holds, path, key, holds ? config : config[key], expected);
    };
    expect("tokenizer_class", {"CLIPTokenizer", "CLIPTokenizerFast", nullptr}, "CLIPTokenizer");
    expect("do_lower_case", {true}, "true");
    expect("padding_side", {"right"}, "right");
    expect("truncation_side", {"right"}, "right");
    expect("split_special_tokens", {false}, "false");
    if (config.contains("model_max_length")) {
        auto const& length = config["model_max_length"];
        // transformers writes 10^30 where there is no limit.
        auto const is_none = length.is_null() || (length.is_number() && length.get<double>() > 1e18);
        auto const is_length =
            length.is_number_unsigned() && length.get<std::uint64_t>() >= 2 && length.get<std::uint64_t>() <= 65536;
        internal::require_key(is_none || is_length, path, "model_max_length", length, "a whole number from 2 to 65536");
        found.context_length = is_none ? found.context_length : length.get<std::size_t>();
    }
    internal::read_purposes(found, config, path, false);

    std::string const decoder = "added_tokens_decoder";
    if (config.contains(decoder)) {
        internal::require_key(config[decoder].is_object(), path, decoder, config[decoder],
                              "an object of tokens by their ids");
        for (auto const& [id, value] : config[decoder].items()) {
            auto const key = decoder + "." + id;
            auto const is_id = !id.empty() && id.size() < 10 && id.find_first_not_of("0123456789") == std::string::npos;
            internal::require_key(is_id && value.is_object(), path, key, value, "a token by its id");
            internal::declare_numbered(found, std::stoul(id), internal::read_declared_token(value, path, key), path,
                                       key);
        }
    } else {
        // Older writers have the tokens in files of their own; those of tokenizer.json come last.
        internal::read_purposes(found, files.object("special_tokens_map.json"), files.path("special_tokens_map.json"),
                                true);
        auto const added_path = files.path("added_tokens.json");
        auto const added = files.object("added_tokens.json");
        for (auto const& [content, id] : added.items()) {
            internal::require_key(internal::is_token_id(id) && !content.empty(), added_path, content, id, "an id");
            auto const is_it = [&, &name = content](auto const& entry) {
                return entry.second && entry.second->content == name;
            };
            auto const is_special = std::any_of(found.named.begin(), found.named.end(), is_it);
            internal::declare_numbered(found, id.get<std::size_t>(), {content, false, is_special, !is_special},
                                       added_path, content);
        }
        if (tokenizer.contains("added_tokens")) {
            auto const tokenizer_path = files.path("tokenizer.json");
            auto const& list = tokenizer["added_tokens"];
            internal::require_key(list.is_array(), tokenizer_path, "added_tokens", list, "a list of tokens");
            for (std::size_t i = 0; i < list.size(); ++i) {
                auto const key = "added_tokens[" + std::to_string(i) + "]";
                internal::require_key(list[i].is_object() && list[i].contains("id") &&
                                          internal::is_token_id(list[i]["id"]),
                                      tokenizer_path, key, list[i], "a token with an id");
                internal::declare_numbered(found, list[i]["id"].get<std::size_t>(),
                                           internal::read_declared_token(list[i], tokenizer_path, key), tokenizer_path,
                                           key);
            }
        }
    }
    return found;
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
