// SPDX-License-Identifier: MIT
// Texts as Unicode code points: from UTF-8 and back, canonical composition, lower case, and what kind a character is.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <utf8proc.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <string>
#include <string_view>

namespace genrender::reference {

/// Code points of a text in UTF-8. Throws value_error naming the function, the argument and the offset of the first byte
/// that begins no valid sequence: a stray or missing continuation, an overlong form, a surrogate, more than U+10FFFF.
inline std::u32string code_points(char const* function, char const* argument, std::string_view text) {
    std::u32string points;
    points.reserve(text.size());
    auto const* bytes = reinterpret_cast<utf8proc_uint8_t const*>(text.data());
    for (std::size_t offset = 0; offset < text.size();) {
        utf8proc_int32_t point = 0;
        auto const left = static_cast<utf8proc_ssize_t>(text.size() - offset);
        auto const length = utf8proc_iterate(bytes + offset, left, &point);
        if (length <= 0) {
            auto const found = "byte " + std::to_string(bytes[offset]) + " at offset " + std::to_string(offset) +
                               ", which begins no character";
            require_value(false, function, argument, found, "valid UTF-8");
        }
        points.push_back(static_cast<char32_t>(point));
        offset += static_cast<std::size_t>(length);
    }
    return points;
}

/// The same text in UTF-8. Code points are those that code_points gives.
inline std::string utf8_text(std::u32string_view points) {
    std::string text;
    text.reserve(points.size());
    for (auto const point : points) {
        std::array<utf8proc_uint8_t, 4> bytes{};
        auto const length = utf8proc_encode_char(static_cast<utf8proc_int32_t>(point), bytes.data());
        assert(length > 0 && "no code point is beyond U+10FFFF");
        text.append(bytes.begin(), bytes.begin() + length);
    }
    return text;
}

/// Whether a character separates words: Unicode's White_Space.
inline bool is_white_space(char32_t point) {
    if (point < 0x80) {
        return point == U' ' || (point >= U'\t' && point <= U'\r');
    }
    auto const category = utf8proc_category(static_cast<utf8proc_int32_t>(point));
    return point == 0x85 || category == UTF8PROC_CATEGORY_ZS || category == UTF8PROC_CATEGORY_ZL ||
           category == UTF8PROC_CATEGORY_ZP;
}

/// Whether a character is a letter, Unicode's category L; combining marks are none.
inline bool is_letter(char32_t point) {
    auto const category = utf8proc_category(static_cast<utf8proc_int32_t>(point));
    return category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_LO;
}

/// Whether a character is a number, Unicode's category N: a digit of any script, a fraction, a Roman numeral.
inline bool is_number(char32_t point) {
    auto const category = utf8proc_category(static_cast<utf8proc_int32_t>(point));
    return category >= UTF8PROC_CATEGORY_ND && category <= UTF8PROC_CATEGORY_NO;
}

/// Unicode's normalisation form C: canonically decomposed, marks in canonical order, composed again. Its time grows with
/// n log(n) however many marks follow each other.
inline std::u32string composed(std::u32string_view points) {
    // Nothing below the first combining mark, U+0300, changes.
    if (std::all_of(points.begin(), points.end(), [](char32_t point) { return point < 0x300; })) {
        return std::u32string(points);
    }
    std::basic_string<utf8proc_int32_t> text;
    text.reserve(points.size());
    for (auto const point : points) {
        std::array<utf8proc_int32_t, 32> parts{}; // canonical decompositions have at most four
        int boundary = UTF8PROC_BOUNDCLASS_START;
        auto const count =
            utf8proc_decompose_char(static_cast<utf8proc_int32_t>(point), parts.data(),
                                    static_cast<utf8proc_ssize_t>(parts.size()), UTF8PROC_DECOMPOSE, &boundary);
        assert(count > 0 && static_cast<std::size_t>(count) <= parts.size() && "a canonical decomposition is short");
        text.append(parts.begin(), parts.begin() + count);
    }
    auto const mark_class = [](utf8proc_int32_t point) { return utf8proc_get_property(point)->combining_class; };
    auto const is_mark = [&](utf8proc_int32_t point) { return mark_class(point) != 0; };
    for (auto begin = text.begin(); begin != text.end();) {
        begin = std::find_if(begin, text.end(), is_mark);
        auto const end = std::find_if_not(begin, text.end(), is_mark);
        std::stable_sort(begin, end, [&](auto a, auto b) { return mark_class(a) < mark_class(b); });
        begin = end;
    }
    auto const options = static_cast<utf8proc_option_t>(UTF8PROC_COMPOSE | UTF8PROC_STABLE);
    auto const length = utf8proc_normalize_utf32(text.data(), static_cast<utf8proc_ssize_t>(text.size()), options);
    assert(length >= 0 && "composition reads and writes what is there");
    return {text.begin(), text.begin() + length};
}

/// Each character in lower case by itself, without regard to its neighbours or to a language: every capital sigma
/// becomes the inner one. Capital I with a dot becomes i and a combining dot.
inline std::u32string lower_case(std::u32string_view points) {
    std::u32string lower;
    lower.reserve(points.size());
    for (auto const point : points) {
        if (point == 0x130) { // the one letter whose lower case is two, which utf8proc_tolower cannot give
            lower += U"i\u0307";
        } else {
            lower.push_back(static_cast<char32_t>(utf8proc_tolower(static_cast<utf8proc_int32_t>(point))));
        }
    }
    return lower;
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
