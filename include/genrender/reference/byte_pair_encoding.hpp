// SPDX-License-Identifier: MIT
// Byte-pair encoding: words of bytes become tokens of a vocabulary by merging neighbours in a fixed order.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/unicode_text.hpp>

#include <array>
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace genrender::reference {

/// How a byte is written in a vocabulary: printable characters of Latin-1 stand for themselves, and the other 68 bytes
/// in order for U+0100 and those that follow [Radford et al. 2019, Language models are unsupervised multitask learners].
inline char32_t byte_letter(unsigned char byte) {
    auto const is_printable = [](unsigned value) {
        return (value >= 0x21 && value <= 0x7e) || (value >= 0xa1 && value != 0xad);
    };
    if (is_printable(byte)) {
        return byte;
    }
    char32_t letter = 0x100;
    for (unsigned value = 0; value < byte; ++value) {
        letter += is_printable(value) ? 0U : 1U;
    }
    return letter;
}

/// A vocabulary, and the merges by which words of bytes become tokens of it. A token is written in letters of
/// byte_letter, with `</w>` behind it if it ends a word.
class byte_pair_encoding {
public:
    /// Takes the id of each token, and which of them stands for a byte that is in no token. Throws value_error if the
    /// ids are not those from 0 on, each once, or there is no `unknown`.
    explicit byte_pair_encoding(std::unordered_map<std::string, std::uint32_t> vocabulary, std::string const& unknown)
        : vocabulary_(std::move(vocabulary)) {
        std::unordered_set<std::uint32_t> ids;
        for (auto const& [token, id] : vocabulary_) {
            if (id >= vocabulary_.size() || !ids.insert(id).second) {
                throw value_error("byte_pair_encoding: id of the token " + token + " is " + std::to_string(id) +
                                  ", expected one below " + std::to_string(vocabulary_.size()) +
                                  ", the number of tokens, that no other token has");
            }
        }
        auto const found = vocabulary_.find(unknown);
        require_value(found != vocabulary_.end(), "byte_pair_encoding", "unknown token", unknown,
                      "a token of the vocabulary");
        unknown_ = found->second;
        for (std::size_t byte = 0; byte < 256; ++byte) {
            auto const letter = byte_letter(static_cast<unsigned char>(byte));
            auto const text = utf8_text({&letter, 1});
            inner_[byte] = id_of(text);
            last_[byte] = id_of(text + "</w>");
        }
    }

    /// Adds a merge, which comes after all that were added before; one that was there already moves to the end. Throws
    /// value_error if one of the two tokens or the one that they become together is not in the vocabulary.
    void add_merge(std::string const& left, std::string const& right) {
        auto const pair = pair_of(checked_id(left), checked_id(right));
        merges_[pair] = {next_rank_++, checked_id(left + right)};
    }

    /// Number of tokens of the vocabulary.
    std::size_t size() const { return vocabulary_.size(); }
    /// Id of the token that stands for bytes that are in no token.
    std::size_t unknown() const { return unknown_; }

    /// Id of a token, nothing if it is not in the vocabulary.
    std::optional<std::uint32_t> id_of(std::string const& token) const {
        auto const found = vocabulary_.find(token);
        return found == vocabulary_.end() ? std::nullopt : std::optional(found->second);
    }

    /// Appends the ids of a word's tokens: beginning with single bytes, of all neighbours that have a merge the one
    /// that was added first is merged, the leftmost of equals, until none has. Returns how many bytes are in no token.
    /// Its time grows with n log(n) of the word's length.
    std::size_t encode(std::string_view word, std::vector<std::size_t>& ids) const {
        std::vector<symbol> symbols;
        symbols.reserve(word.size());
        std::size_t unknown_bytes = 0;
        for (std::size_t i = 0; i < word.size(); ++i) {
            auto const& table = i + 1 == word.size() ? last_ : inner_;
            auto const id = table[static_cast<unsigned char>(word[i])];
            unknown_bytes += id ? 0U : 1U;
            symbols.push_back({id.value_or(unknown_), i + 1, i == 0 ? none : i - 1});
        }
        std::priority_queue<candidate, std::vector<candidate>, std::greater<>> candidates;
        auto const propose = [&](std::size_t place) {
            auto const next = symbols[place].next;
            if (next == symbols.size()) {
                return;
            }
            auto const found = merges_.find(pair_of(symbols[place].id, symbols[next].id));
            if (found != merges_.end()) {
                candidates.push({found->second.rank, place, found->first, found->second.id});
            }
        };
        for (std::size_t i = 0; i < symbols.size(); ++i) {
            propose(i);
        }
        while (!candidates.empty()) {
            auto const best = candidates.top();
            candidates.pop();
            auto& left = symbols[best.place];
            // Neighbours may have merged since; a symbol that another took in has no successor of its own any more.
            if (left.next == none || left.next == symbols.size() ||
                pair_of(left.id, symbols[left.next].id) != best.pair) {
                continue;
            }
            auto& right = symbols[left.next];
            left.id = best.id;
            left.next = right.next;
            right.next = none;
            if (left.next != symbols.size()) {
                symbols[left.next].previous = best.place;
            }
            if (left.previous != none) {
                propose(left.previous);
            }
            propose(best.place);
        }
        for (std::size_t i = 0; i < symbols.size(); i = symbols[i].next) {
            ids.push_back(symbols[i].id);
        }
        return unknown_bytes;
    }

private:
    /// A part of a word, with the places of its neighbours. `next` of the last is the number of bytes.
    struct symbol {
        std::uint32_t id;
        std::size_t next;
        std::size_t previous;
    };
    /// What a pair becomes, and when.
    struct merge {
        std::uint32_t rank;
        std::uint32_t id;
    };
    /// A merge that was possible when it was noted.
    struct candidate {
        std::uint32_t rank;
        std::size_t place;
        std::uint64_t pair;
        std::uint32_t id;
        friend auto operator<=>(candidate const&, candidate const&) = default;
    };

    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

    static std::uint64_t pair_of(std::uint32_t left, std::uint32_t right) {
        return (static_cast<std::uint64_t>(left) << 32) | right;
    }

    std::uint32_t checked_id(std::string const& token) const {
        auto const id = id_of(token);
        require_value(id.has_value(), "byte_pair_encoding", "token of a merge", token, "a token of the vocabulary");
        return *id;
    }

    std::unordered_map<std::string, std::uint32_t> vocabulary_;
    std::unordered_map<std::uint64_t, merge> merges_;
    std::uint32_t next_rank_ = 0;
    std::uint32_t unknown_ = 0;
    std::array<std::optional<std::uint32_t>, 256> inner_; ///< tokens of single bytes within a word
    std::array<std::optional<std::uint32_t>, 256> last_;  ///< and at its end
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
