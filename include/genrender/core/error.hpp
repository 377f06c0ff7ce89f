// SPDX-License-Identifier: MIT
// What a caller did wrong, as an exception whose text names the function, the argument, what it is and what was
// expected.
#pragma once

#include <genrender/core/begin_header.inl>

#if !defined(__cpp_exceptions) && !defined(_CPPUNWIND)
#error "genrender tells errors by exceptions: compile without -fno-exceptions"
#endif

#include <cstddef>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace genrender {

/// An argument has the wrong extents. Text: `function: argument is [2, 1], expected [2, 2]`.
struct shape_error : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

/// An argument has the right extents and an impossible value. Text: `function: argument is -1, expected ...`.
struct value_error : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

/// A file cannot be read or written, or does not hold what it should. Text: `path: what was found, what was expected`.
struct file_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The observer of a run asked for it to end. Nothing that was finished before is lost.
struct cancelled : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Extents as text: `[2, 64, 64]`.
template <class Extents>
std::string extents_text(Extents const& extents) {
    std::string text = "[";
    for (auto const& extent : extents) {
        text += (text.size() > 1 ? ", " : "") + std::to_string(extent);
    }
    return text + "]";
}

/// Extents written in braces as text.
inline std::string extents_text(std::initializer_list<std::size_t> extents) {
    return extents_text<std::initializer_list<std::size_t>>(extents);
}

/// Throws shape_error unless `found` equals `expected` axis by axis.
template <class Found, class Expected>
void require_extents(char const* function, char const* argument, Found const& found, Expected const& expected) {
    auto const found_text = extents_text(found);
    auto const expected_text = extents_text(expected);
    if (found_text != expected_text) {
        throw shape_error(std::string(function) + ": " + argument + " is " + found_text + ", expected " +
                          expected_text);
    }
}

/// Throws value_error `function: argument is FOUND, expected EXPECTED` unless `holds`.
template <class Found>
void require_value(bool holds, char const* function, char const* argument, Found const& found, char const* expected) {
    if (holds) {
        return;
    }
    std::string found_text;
    if constexpr (std::is_arithmetic_v<Found>) {
        found_text = std::to_string(found);
    } else {
        found_text = std::string(found);
    }
    throw value_error(std::string(function) + ": " + argument + " is " + found_text + ", expected " + expected);
}

} // namespace genrender

#include <genrender/core/end_header.inl>
