// SPDX-License-Identifier: MIT
// A byte-pair encoding from its files: vocab.json with merges.txt, or a tokenizer.json.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/byte_pair_encoding.hpp>
#include <genrender/reference/checked_json.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace genrender::reference {

namespace internal {

/// Throws file_error `path: key KEY is FOUND, expected EXPECTED` unless `holds`.
inline void require_key(bool holds, std::string const& path, std::string const& key, nlohmann::json const& found,
                        std::string const& expected) {
    if (!holds) {
        // Long ones are not written out first: nothing says how long they are.
        auto text = found.is_structured() && !found.empty() ? std::string("a JSON ") + found.type_name() : found.dump();
        text = text.size() <= 80 ? text : text.substr(0, 77) + "...";
        throw file_error(path + ": key " + key + " is " + text + ", expected " + expected);
    }
}

/// The JSON object that a text is. Throws file_error if it is something else, or has a key twice.
inline nlohmann::json json_object(std::string const& text, std::string const& path) {
    auto json = checked_json(text, path, "file", "an object");
    if (!json.is_object()) {
        throw file_error(path + ": file is a JSON " + json.type_name() + ", expected an object");
    }
    return json;
}

/// Whether a value can be the id of a token.
inline bool is_token_id(nlohmann::json const& value) {
    return value.is_number_unsigned() && value.get<std::uint64_t>() <= std::numeric_limits<std::uint32_t>::max();
}

/// The encoding of an object of ids by tokens, without merges. `prefix` stands before keys in errors.
inline byte_pair_encoding encoding_of_vocabulary(nlohmann::json const& object, std::string const& path,
                                                 std::string const& prefix, std::string const& unknown) {
    std::unordered_map<std::string, std::uint32_t> vocabulary;
    vocabulary.reserve(object.size());
    for (auto const& [token, id] : object.items()) {
        require_key(is_token_id(id), path, prefix + token, id, "the token's id, a whole number from 0");
        vocabulary.emplace(token, id.get<std::uint32_t>());
    }
    try {
        return byte_pair_encoding(std::move(vocabulary), unknown);
    } catch (value_error const& error) {
        throw file_error(path + ": " + error.what());
    }
}

/// Adds the merge that a text says, two tokens with one space between; `place` is where it stands.
inline void add_merge(byte_pair_encoding& encoding, std::string const& text, std::string const& place) {
    auto const space = text.find(' ');
    if (space == std::string::npos || text.find(' ', space + 1) != std::string::npos) {
        auto const found = text.size() <= 80 ? text : text.substr(0, 77) + "...";
        throw file_error(place + " is '" + found + "', expected two tokens with one space between");
    }
    try {
        encoding.add_merge(text.substr(0, space), text.substr(space + 1));
    } catch (value_error const& error) {
        throw file_error(place + ": " + error.what());
    }
}

} // namespace internal

/// The encoding of the texts of vocab.json, an object of ids by tokens, and merges.txt, a merge a line in the order of
/// their use. Lines that begin with `#version` do not count, nor does an empty last one. `unknown` is the token for bytes
/// that are in no other. Throws file_error naming the path with the key or the line for what cannot be.
inline byte_pair_encoding encoding_of_vocabulary_and_merges(std::string const& vocabulary,
                                                            std::string const& vocabulary_path,
                                                            std::string const& merges, std::string const& merges_path,
                                                            std::string const& unknown) {
    auto encoding = internal::encoding_of_vocabulary(internal::json_object(vocabulary, vocabulary_path),
                                                     vocabulary_path, "", unknown);
    std::size_t line = 1;
    for (std::size_t begin = 0; begin < merges.size(); ++line) {
        auto const end = std::min(merges.find('\n', begin), merges.size());
        auto text = merges.substr(begin, end - begin);
        begin = end + 1;
        if (text.ends_with('\r')) {
            text.pop_back();
        }
        if (!text.starts_with("#version")) {
            internal::add_merge(encoding, text, merges_path + ": line " + std::to_string(line));
        }
    }
    return encoding;
}

/// The encoding of the content of a tokenizer.json: the vocabulary and the merges of its model, which must be a BPE with
/// `</w>` at the end of words. Merges are texts as in merges.txt or pairs. Throws file_error as the other does.
inline byte_pair_encoding encoding_of_tokenizer(nlohmann::json const& tokenizer, std::string const& path,
                                                std::string const& unknown) {
    nlohmann::json const null;
    auto const member = [&](nlohmann::json const& object, char const* key) -> nlohmann::json const& {
        return object.is_object() && object.contains(key) ? object[key] : null;
    };
    auto const& model = member(tokenizer, "model");
    internal::require_key(model.is_object(), path, "model", model, "an object");
    auto const expect = [&](char const* key, char const* expected, bool may_be_absent) {
        auto const& found = member(model, key);
        internal::require_key(found == expected || (may_be_absent && found.is_null()), path,
                              std::string("model.") + key, found, "\"" + std::string(expected) + "\", as CLIP's is");
    };
    expect("type", "BPE", true);
    expect("end_of_word_suffix", "</w>", false);
    expect("continuing_subword_prefix", "", true);
    auto const& vocabulary = member(model, "vocab");
    internal::require_key(vocabulary.is_object(), path, "model.vocab", vocabulary, "an object of ids by tokens");
    auto encoding = internal::encoding_of_vocabulary(vocabulary, path, "model.vocab.", unknown);
    auto const& merges = member(model, "merges");
    internal::require_key(merges.is_array(), path, "model.merges", merges, "a list of merges");
    for (std::size_t i = 0; i < merges.size(); ++i) {
        auto const& merge = merges[i];
        auto const key = "model.merges[" + std::to_string(i) + "]";
        auto const is_pair = merge.is_array() && merge.size() == 2 && merge[0].is_string() && merge[1].is_string();
        internal::require_key(is_pair || merge.is_string(), path, key, merge, "two tokens");
        auto const text =
            is_pair ? merge[0].get<std::string>() + " " + merge[1].get<std::string>() : merge.get<std::string>();
        internal::add_merge(encoding, text, path + ": key " + key);
    }
    return encoding;
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
