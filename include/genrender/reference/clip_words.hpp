// SPDX-License-Identifier: MIT
// How CLIP cleans a text and cuts it into the words that its byte-pair encoding takes one by one.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/unicode_text.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::reference {

/// A text as CLIP's encoding sees it: composed (NFC), each run of white space one space, in lower case.
inline std::u32string clip_cleaned(std::u32string_view text) {
    std::u32string spaced;
    auto const whole = composed(text);
    spaced.reserve(whole.size());
    for (auto const point : whole) {
        if (!is_white_space(point)) {
            spaced.push_back(point);
        } else if (spaced.empty() || spaced.back() != U' ') {
            spaced.push_back(U' ');
        }
    }
    return lower_case(spaced);
}

namespace internal {

/// Length of an English ending at the beginning of a text: 's 't 're 've 'm 'll 'd; 0 if there is none.
inline std::size_t clip_ending(std::u32string_view text) {
    constexpr std::array<std::u32string_view, 7> endings{U"'s", U"'t", U"'re", U"'ve", U"'m", U"'ll", U"'d"};
    for (auto const ending : endings) {
        if (text.starts_with(ending)) {
            return ending.size();
        }
    }
    return 0;
}

/// Length of the word inside the name of a special token with which a text begins; 0 if it begins with none.
inline std::size_t clip_special_name(std::u32string_view text) {
    constexpr std::array<std::u32string_view, 2> names{U"<|startoftext|>", U"<|endoftext|>"};
    for (auto const name : names) {
        if (text.starts_with(name)) {
            return name.size() - 4;
        }
    }
    return 0;
}

} // namespace internal

/// The words of a cleaned text, in order: runs of letters, single numbers, English endings ('s 't 're 've 'm 'll 'd) and
/// runs of what is neither letter, number nor white space. White space is left out. The names of special tokens are cut
/// out too, into `<|`, the letters and `|>`: where such a name is to be one token, the tokenizer has taken it out before.
inline std::vector<std::u32string_view> clip_words(std::u32string_view cleaned) {
    std::vector<std::u32string_view> words;
    auto const is_other = [](char32_t point) {
        return !is_white_space(point) && !is_letter(point) && !is_number(point);
    };
    for (std::size_t i = 0; i < cleaned.size();) {
        auto const rest = cleaned.substr(i);
        auto const run = [&](auto const& belongs) {
            return static_cast<std::size_t>(std::find_if_not(rest.begin(), rest.end(), belongs) - rest.begin());
        };
        std::size_t length = 1;
        if (auto const name = internal::clip_special_name(rest); name > 0) {
            words.push_back(rest.substr(0, 2));
            words.push_back(rest.substr(2, name));
            words.push_back(rest.substr(2 + name, 2));
            i += name + 4;
            continue;
        }
        if (auto const ending = internal::clip_ending(rest); ending > 0) {
            length = ending;
        } else if (is_letter(rest.front())) {
            length = run(is_letter);
        } else if (is_other(rest.front())) {
            length = run(is_other);
        }
        if (!is_white_space(rest.front())) {
            words.push_back(rest.substr(0, length));
        }
        i += length;
    }
    return words;
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
