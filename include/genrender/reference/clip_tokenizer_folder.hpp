// SPDX-License-Identifier: MIT
// CLIP's tokenizer from a folder `tokenizer/` in diffusers' layout, as transformers would make it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/byte_pair_files.hpp>
#include <genrender/reference/clip_added_tokens.hpp>
#include <genrender/reference/clip_declarations.hpp>
#include <genrender/reference/clip_tokenizer.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace genrender::reference {

namespace internal {

/// The token of a purpose, as a token with an id of the same name declares it if there is one. CLIP's own where the
/// files say nothing; nothing where they say null.
inline std::optional<clip_declared_token> token_of_purpose(clip_declarations const& declared,
                                                           std::string const& purpose) {
    auto const found = declared.named.find(purpose);
    std::optional<clip_declared_token> token;
    if (found != declared.named.end()) {
        token = found->second;
    } else if (purpose == "bos_token") {
        token = clip_declared_token{"<|startoftext|>", true, true, {}};
    } else if (purpose == "eos_token" || purpose == "unk_token" || purpose == "pad_token") {
        token = clip_declared_token{"<|endoftext|>", true, true, {}};
    }
    for (auto const& [id, other] : declared.numbered) {
        if (token && other.content == token->content && found != declared.named.end()) {
            token = other;
        }
    }
    return token;
}

/// All tokens that stand in texts by their names, in the order in which transformers adds them; of equal names the last
/// one counts.
inline std::vector<clip_added_token> added_tokens(clip_declarations const& declared) {
    std::vector<clip_declared_token> tokens;
    for (auto const& [id, token] : declared.numbered) {
        tokens.push_back(token);
    }
    std::set<std::string> numbered;
    std::set<std::tuple<std::string, bool, bool, bool>> known;
    auto const add = [&](clip_declared_token const& token) {
        auto const is_new = known.emplace(token.content, token.is_name, token.is_special, token.in_cleaned()).second;
        if (is_new && !numbered.contains(token.content)) {
            tokens.push_back(token);
        }
    };
    for (auto const& token : tokens) {
        numbered.insert(token.content);
    }
    std::vector<std::string> with_purpose;
    for (auto const* purpose : clip_purposes) {
        if (auto const token = token_of_purpose(declared, purpose)) {
            with_purpose.push_back(token->content);
            add(*token);
        }
    }
    std::for_each(declared.others.begin(), declared.others.end(), add);
    std::vector<clip_added_token> added;
    for (auto& token : tokens) {
        auto const has_purpose =
            std::find(with_purpose.begin(), with_purpose.end(), token.content) != with_purpose.end();
        token.is_special = token.is_special || has_purpose;
        added.push_back({token.content, token.in_cleaned()});
    }
    return added;
}

} // namespace internal

/// The tokenizer of the texts of a folder's files. Throws file_error naming the file, and the key or the line, for what is
/// not there, cannot be, or is no tokenizer of CLIP.
inline clip_tokenizer make_clip_tokenizer(clip_tokenizer_files const& files) {
    auto const has_tokenizer = files.has("tokenizer.json");
    auto const tokenizer = files.object("tokenizer.json");
    for (auto const* name : {"vocab.json", "merges.txt"}) {
        if (!has_tokenizer && !files.has(name)) {
            throw file_error(files.path(name) + ": there is no such file, expected vocab.json and merges.txt, or " +
                             "tokenizer.json");
        }
    }
    auto const declared = read_clip_declarations(files, tokenizer);
    auto const name_of = [&](char const* purpose) {
        auto const token = internal::token_of_purpose(declared, purpose);
        if (!token) {
            throw file_error(files.path("tokenizer_config.json") + ": key " + purpose + " is null, expected a token");
        }
        return token->content;
    };
    auto const unknown = name_of("unk_token");
    auto encoding =
        has_tokenizer
            ? encoding_of_tokenizer(tokenizer, files.path("tokenizer.json"), unknown)
            : encoding_of_vocabulary_and_merges(files.texts.at("vocab.json"), files.path("vocab.json"),
                                                files.texts.at("merges.txt"), files.path("merges.txt"), unknown);
    clip_tokenizer made(std::move(encoding), {name_of("bos_token"), name_of("eos_token"), name_of("pad_token"),
                                              declared.context_length, internal::added_tokens(declared)});
    for (auto const& [id, token] : declared.numbered) {
        if (made.id_of(token.content) != id) {
            throw file_error(declared.places.at(id) + ": id of the token " + token.content + " is " +
                             std::to_string(id) + ", expected " + std::to_string(made.id_of(token.content)) +
                             ", its id in the vocabulary or the next one behind that");
        }
    }
    return made;
}

/// The tokenizer of a folder: vocab.json with merges.txt, or tokenizer.json, which counts if both are there; and, if they
/// are there, tokenizer_config.json, special_tokens_map.json and added_tokens.json. Throws file_error as
/// make_clip_tokenizer does, and if a file cannot be read.
inline clip_tokenizer load_clip_tokenizer(std::filesystem::path const& folder) {
    clip_tokenizer_files files{folder, {}};
    for (auto const* name : {"vocab.json", "merges.txt", "tokenizer.json", "tokenizer_config.json",
                             "special_tokens_map.json", "added_tokens.json"}) {
        auto const path = folder / name;
        if (!std::filesystem::exists(path)) {
            continue;
        }
        std::ifstream file(path, std::ios::binary);
        // A folder opens too, but has no first byte.
        if (!file.is_open() || (file.peek() == std::ifstream::traits_type::eof() && file.bad())) {
            throw file_error(path.string() + ": file cannot be read, expected a readable file");
        }
        files.texts[name] = {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    }
    return make_clip_tokenizer(files);
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
