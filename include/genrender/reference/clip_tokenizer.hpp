// SPDX-License-Identifier: MIT
// CLIP's tokenizer: a prompt becomes the numbers that a text encoder looks its embeddings up by.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/byte_pair_encoding.hpp>
#include <genrender/reference/clip_added_tokens.hpp>
#include <genrender/reference/clip_words.hpp>
#include <genrender/reference/unicode_text.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::reference {

/// A word of a prompt, and what became of it.
struct clip_word {
    std::string text;        ///< cleaned, in UTF-8
    std::size_t tokens = 0;  ///< how many tokens it became; at least one
    std::size_t kept = 0;    ///< how many of them are in the prompt's ids: fewer if the prompt was cut
    std::size_t unknown = 0; ///< how many of its bytes are in no token of the vocabulary
};

/// A prompt as CLIP's text encoder takes it.
struct clip_prompt {
    std::vector<std::size_t> ids; ///< [context length]: the start, tokens of the text, the end, padding
    std::size_t tokens = 0;       ///< how many of the text are in ids, without start and end
    std::size_t cut = 0;          ///< how many of the text had no room
    std::vector<clip_word> words; ///< all words of the text, those that had no room too

    /// Words of which at least one token had no room, joined by spaces; empty if nothing was cut.
    std::string cut_text() const {
        return text_of([](clip_word const& word) { return word.kept < word.tokens; });
    }
    /// Words that are no token as a whole, joined by spaces. Of a vocabulary that was made of a small world's captions,
    /// words that stand in none of them.
    std::string split_text() const {
        return text_of([](clip_word const& word) { return word.tokens > 1 || word.unknown > 0; });
    }

private:
    template <class Condition>
    std::string text_of(Condition const& holds) const {
        std::string text;
        for (auto const& word : words) {
            if (holds(word)) {
                text += (text.empty() ? "" : " ") + word.text;
            }
        }
        return text;
    }
};

/// The tokens of CLIP that are not words, by their names, and how long a prompt is.
struct clip_special_tokens {
    std::string start = "<|startoftext|>"; ///< begins every prompt
    std::string end = "<|endoftext|>";     ///< ends the text of every prompt
    std::string padding = "<|endoftext|>"; ///< fills what is left
    std::size_t context_length = 77;       ///< tokens of a prompt with all of these; at least 2
    std::vector<clip_added_token> added;   ///< what stands in texts by its name; the three above do in any case
};

/// Turns prompts into ids as transformers' CLIPTokenizer does with padding to, and truncation at, its longest prompt.
///
/// Characters are classified, composed and lowered as the Unicode version of utf8proc says. What is newer than that is
/// neither letter nor number.
class clip_tokenizer {
public:
    /// Takes an encoding and the special tokens; what the encoding's vocabulary lacks of these gets the next numbers
    /// behind it. Throws value_error if the context length is below 2, or a name is empty or no UTF-8.
    clip_tokenizer(byte_pair_encoding encoding, clip_special_tokens const& special)
        : encoding_(std::move(encoding)), added_(encoding_, all_added(special)), start_(added_.id_of(special.start)),
          end_(added_.id_of(special.end)), padding_(added_.id_of(special.padding)),
          context_length_(special.context_length) {
        require_value(context_length_ >= 2, "clip_tokenizer", "context_length", context_length_, "at least 2");
    }

    /// Number of ids of every prompt.
    std::size_t context_length() const { return context_length_; }
    /// Number of tokens that there are: rows of the text encoder's embeddings.
    std::size_t size() const { return added_.size(); }
    /// Id of a token that stands in texts by its name. Throws std::out_of_range if there is none of that name.
    std::size_t id_of(std::string const& name) const { return added_.id_of(name); }
    /// Id with which every prompt begins.
    std::size_t start() const { return start_; }
    /// Id that stands behind the text.
    std::size_t end() const { return end_; }
    /// Id that fills a prompt up.
    std::size_t padding() const { return padding_; }

    /// The ids of a text in UTF-8 of any length; what has no room is cut off at the end and counted. A byte that is in no
    /// token of the vocabulary becomes the unknown token. Throws value_error naming the offset of the first byte that is
    /// no UTF-8.
    clip_prompt operator()(std::string_view text) const {
        auto const points = code_points("clip_tokenizer", "text", text);
        clip_prompt prompt;
        auto const room = context_length_ - 2;
        prompt.ids.reserve(context_length_);
        prompt.ids.push_back(start_);
        // Room is kept for the end; words beyond the room are encoded too, so that they can be told.
        std::vector<std::size_t> of_word;
        auto const add = [&](clip_word word) {
            word.tokens = of_word.size();
            word.kept = std::min(word.tokens, room - prompt.tokens);
            prompt.tokens += word.kept;
            prompt.cut += word.tokens - word.kept;
            prompt.ids.insert(prompt.ids.end(), of_word.begin(),
                              of_word.begin() + static_cast<std::ptrdiff_t>(word.kept));
            prompt.words.push_back(std::move(word));
        };
        added_.visit(
            points,
            [&](std::u32string_view cleaned) {
                for (auto const word : clip_words(cleaned)) {
                    of_word.clear();
                    auto bytes = utf8_text(word);
                    auto const unknown = encoding_.encode(bytes, of_word);
                    add({std::move(bytes), 0, 0, unknown});
                }
            },
            [&](std::size_t id, std::u32string_view name) {
                of_word.assign(1, id);
                add({utf8_text(name), 0, 0, 0});
            });
        prompt.ids.push_back(end_);
        prompt.ids.resize(context_length_, padding_);
        return prompt;
    }

private:
    /// The listed tokens, then the special ones that are not among them.
    static std::vector<clip_added_token> all_added(clip_special_tokens const& special) {
        std::vector<clip_added_token> tokens = special.added;
        for (auto const* name : {&special.start, &special.end, &special.padding}) {
            auto const is_it = [&](clip_added_token const& token) { return token.content == *name; };
            if (std::none_of(tokens.begin(), tokens.end(), is_it)) {
                tokens.push_back({*name, false});
            }
        }
        return tokens;
    }

    byte_pair_encoding encoding_;
    clip_added_tokens added_;
    std::size_t start_;
    std::size_t end_;
    std::size_t padding_;
    std::size_t context_length_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
