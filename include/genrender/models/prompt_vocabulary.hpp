// SPDX-License-Identifier: MIT
// The few words that the reference network understands, and the tokens they become.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/models/weights.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender {

/// The words, in the order of their rows in the table of embeddings; row 0 is the start of every prompt.
inline constexpr std::array<std::string_view, 8> prompt_words{"checker", "stripes", "dots",  "bricks",
                                                              "marble",  "rings",   "plain", "camo"};

/// Rows of the table of embeddings for a text: 0, then one for each word. Letter case does not matter; everything but
/// letters and digits separates words. Throws value_error naming a word that is not among prompt_words, and those that
/// are.
inline std::vector<std::size_t> prompt_rows(std::string_view text) {
    std::vector<std::size_t> rows{0};
    std::string word;
    auto const finish_word = [&] {
        if (word.empty()) {
            return;
        }
        auto const found = std::find(prompt_words.begin(), prompt_words.end(), word);
        if (found == prompt_words.end()) {
            std::string known;
            for (auto const& entry : prompt_words) {
                known += (known.empty() ? "" : " ") + std::string(entry);
            }
            throw value_error("prompt_vocabulary: word is " + word + ", expected one of " + known);
        }
        rows.push_back(static_cast<std::size_t>(found - prompt_words.begin()) + 1);
        word.clear();
    };
    for (auto const letter : text) {
        auto const lower = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
        // Bytes of other alphabets count as letters, so that an unknown word is named whole.
        auto const in_word = (lower >= 'a' && lower <= 'z') || (lower >= '0' && lower <= '9') || (lower & 0x80) != 0;
        if (in_word) {
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
    /// Takes `token_embedding.weight` [9, channels]. Throws file_error if it is missing, misshapen or not alone.
    prompt_vocabulary(weights<Real>& source, std::size_t channels) : table_({prompt_words.size() + 1, channels}) {
        auto const values = source.take("token_embedding.weight", {prompt_words.size() + 1, channels});
        std::copy(values.begin(), values.end(), table_.data());
        source.require_all_taken();
    }

    /// The tokens of a text [tokens, channels]; the empty text has one. Throws value_error as prompt_rows does.
    stack<Real, 2> operator()(std::string_view text) const {
        auto const rows = prompt_rows(text);
        stack<Real, 2> tokens({rows.size(), table_.extent(1)});
        for (std::size_t i = 0; i < rows.size(); ++i) {
            copy(tokens.view()[i], strided_view<Real const, 1>(table_.view()[rows[i]]));
        }
        return tokens;
    }

private:
    stack<Real, 2> table_;
};

} // namespace genrender
