// SPDX-License-Identifier: MIT
// The few words that the reference network understands, and the tokens they become.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::reference {

/// The words unless others are given, in the order of their rows in the table of embeddings; row 0 is the start of
/// every prompt.
inline constexpr std::array<std::string_view, 11> prompt_words{"plain",  "stripes", "checker", "dots",   "camo", "red",
                                                               "yellow", "green",   "blue",    "purple", "white"};

namespace internal {

/// Whether a byte belongs to a word of lower-case letters and digits. Bytes of other alphabets count as letters, so
/// that an unknown word is named whole.
inline bool is_prompt_letter(char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || (letter & 0x80) != 0;
}

/// Whether prompt_rows could find this word.
inline bool is_prompt_word(std::string_view word) {
    return !word.empty() && std::all_of(word.begin(), word.end(), is_prompt_letter);
}

} // namespace internal

/// Rows of the table of embeddings for a text: 0, then one for each word. Letter case does not matter; everything but
/// letters and digits separates words. Throws value_error naming a word that is not among `words`, and those that are.
template <class Words = decltype(prompt_words)>
std::vector<std::size_t> prompt_rows(std::string_view text, Words const& words = prompt_words) {
    std::vector<std::size_t> rows{0};
    std::string word;
    auto const finish_word = [&] {
        if (word.empty()) {
            return;
        }
        auto const found = std::find(words.begin(), words.end(), word);
        if (found == words.end()) {
            std::string known;
            for (auto const& entry : words) {
                known += (known.empty() ? "" : " ") + std::string(entry);
            }
            throw value_error("prompt_vocabulary: word is " + word + ", expected one of " + known);
        }
        rows.push_back(static_cast<std::size_t>(found - words.begin()) + 1);
        word.clear();
    };
    for (auto const letter : text) {
        auto const lower = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
        if (internal::is_prompt_letter(lower)) {
            word += lower;
        } else {
            finish_word();
        }
    }
    finish_word();
    return rows;
}

/// Turns texts into tokens for cross-attention: the text encoder in miniature, a table.
template <class Real>
class prompt_vocabulary {
public:
    /// Takes `token_embedding.weight` [1 + words, channels]. Throws file_error if it is missing, misshapen or not
    /// alone.
    prompt_vocabulary(weights<Real>& source, std::size_t channels,
                      std::vector<std::string> words = {prompt_words.begin(), prompt_words.end()})
        : words_(std::move(words)), table_({words_.size() + 1, channels}) {
        auto const values = source.take("token_embedding.weight", {words_.size() + 1, channels});
        std::copy(values.begin(), values.end(), table_.data());
        source.require_all_taken();
    }

    /// The embeddings of the start of a prompt and of each word [1 + words, channels].
    strided_view<Real const, 2> table() const { return table_.view(); }
    /// The words it knows, in the order of their rows from 1 on.
    std::vector<std::string> const& words() const { return words_; }

    /// The tokens of a text [tokens, channels]; the empty text has one. Throws value_error as prompt_rows does.
    stack<Real, 2> operator()(std::string_view text) const {
        auto const rows = prompt_rows(text, words_);
        stack<Real, 2> tokens({rows.size(), table_.extent(1)});
        for (std::size_t i = 0; i < rows.size(); ++i) {
            copy(tokens.view()[i], strided_view<Real const, 1>(table_.view()[rows[i]]));
        }
        return tokens;
    }

private:
    std::vector<std::string> words_;
    stack<Real, 2> table_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
