// SPDX-License-Identifier: MIT
// Tokens that are not spelled from bytes but stand in a text by their names: the special ones, and those that were
// learnt later.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/byte_pair_encoding.hpp>
#include <genrender/reference/clip_words.hpp>
#include <genrender/reference/unicode_text.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace genrender::reference {

/// A token by its name.
struct clip_added_token {
    std::string content;     ///< its name, as texts have it; UTF-8, 1 to 1000 bytes
    bool is_cleaned = false; ///< whether it is looked for in the cleaned text instead of the text as it was written
    /// Equal names that are looked for in the same way.
    friend bool operator==(clip_added_token const&, clip_added_token const&) = default;
};

namespace internal {

/// Names that are looked for in texts, as a tree whose branches are characters.
class name_search {
public:
    /// Adds a name; one that is there already keeps its id.
    void add(std::u32string_view name, std::size_t id) {
        std::uint32_t node = 0;
        for (auto const point : name) {
            auto const next = static_cast<std::uint32_t>(ids_.size());
            auto const found = branches_.emplace(branch(node, point), next);
            if (found.second) {
                ids_.emplace_back();
            }
            node = found.first->second;
        }
        ids_[node] = ids_[node].value_or(id);
    }

    /// Calls `on_text` with what lies between names, none of it empty, and `on_name` with each name's id and text, in
    /// order. Of names that begin at one place the longest counts.
    template <class OnText, class OnName>
    void visit(std::u32string_view text, OnText&& on_text, OnName&& on_name) const {
        std::size_t begin = 0;
        for (std::size_t i = 0; i < text.size();) {
            std::size_t length = 0;
            std::size_t id = 0;
            auto node = branches_.find(branch(0, text[i]));
            for (auto end = i + 1; node != branches_.end(); ++end) {
                if (auto const& found = ids_[node->second]) {
                    length = end - i;
                    id = *found;
                }
                node = end < text.size() ? branches_.find(branch(node->second, text[end])) : branches_.end();
            }
            if (length == 0) {
                ++i;
                continue;
            }
            if (begin < i) {
                on_text(text.substr(begin, i - begin));
            }
            on_name(id, text.substr(i, length));
            i += length;
            begin = i;
        }
        if (begin < text.size()) {
            on_text(text.substr(begin));
        }
    }

private:
    static std::uint64_t branch(std::uint32_t node, char32_t point) {
        return (static_cast<std::uint64_t>(node) << 32) | point;
    }

    std::unordered_map<std::uint64_t, std::uint32_t> branches_; ///< the node behind a node and a character
    std::vector<std::optional<std::size_t>> ids_ = std::vector<std::optional<std::size_t>>(1); ///< by node, of names
};

} // namespace internal

/// The tokens of a text that stand there by their names, and the cleaned text between them.
class clip_added_tokens {
public:
    /// Looks each token up in the vocabulary; one that is not there gets the next number behind it. Of equal names the
    /// last one counts. Throws value_error if a name is empty, longer than 1000 bytes or no UTF-8.
    clip_added_tokens(byte_pair_encoding const& vocabulary, std::vector<clip_added_token> const& tokens)
        : size_(vocabulary.size()) {
        for (auto const& token : tokens) {
            auto const bytes = token.content.size();
            require_value(bytes > 0 && bytes <= 1000, "clip_added_tokens", "length of a name", bytes,
                          "1 to 1000 bytes");
            std::size_t const next = size_;
            auto const known = vocabulary.id_of(token.content);
            auto const added = ids_.emplace(token.content, known.value_or(next));
            if (added.second && !known) {
                ++size_;
            }
        }
        std::unordered_set<std::string> seen;
        for (auto token = tokens.rbegin(); token != tokens.rend(); ++token) {
            if (!seen.insert(token->content).second) {
                continue;
            }
            auto const name = code_points("clip_added_tokens", "name", token->content);
            auto& search = token->is_cleaned ? cleaned_ : written_;
            search.add(token->is_cleaned ? clip_cleaned(name) : name, ids_.at(token->content));
        }
    }

    /// Id of a token by its name. Throws std::out_of_range if it was not among those given.
    std::size_t id_of(std::string const& content) const { return ids_.at(content); }
    /// Number of tokens of the vocabulary and of those that came after it.
    std::size_t size() const { return size_; }

    /// Calls, in order, `on_text` with cleaned text and `on_name` with the id and the text of a token that stands there
    /// by its name. Tokens that are looked for in the text as it was written come before those in the cleaned text.
    template <class OnText, class OnName>
    void visit(std::u32string_view text, OnText&& on_text, OnName&& on_name) const {
        written_.visit(
            text, [&](std::u32string_view part) { cleaned_.visit(clip_cleaned(part), on_text, on_name); }, on_name);
    }

private:
    std::size_t size_;
    std::unordered_map<std::string, std::size_t> ids_;
    internal::name_search written_;
    internal::name_search cleaned_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
