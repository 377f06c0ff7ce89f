// SPDX-License-Identifier: MIT
// Numbers and names as the tables of benchmarks write them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <span>
#include <string>

namespace genrender::benchmarks {

namespace detail {

/// A number with three digits that count: 0.0123, 1.23, 123, 12300.
inline std::string three_digits(double value) {
    std::array<char, 32> text{};
    auto const size = std::abs(value);
    auto decimals = size == 0 ? 0 : 4;
    for (auto next = 0.09995; decimals > 0 && size >= next; next *= 10) {
        --decimals;
    }
    std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
    return text.data();
}

/// A value with the prefix of its unit, `units` from the smallest on, each 1000 times the one before.
inline std::string with_unit(double value, std::span<char const* const> units) {
    std::size_t u = 0;
    for (; u + 1 < units.size() && value >= 999.5; ++u) {
        value /= 1000;
    }
    return three_digits(value) + " " + units[u];
}

inline std::string bytes_text(double bytes) { return with_unit(bytes, std::array{"B", "kB", "MB", "GB", "TB"}); }

/// The size of a memory, each unit 1024 times the one before.
inline std::string memory_text(double bytes) {
    constexpr std::array units{"B", "KiB", "MiB", "GiB", "TiB"};
    std::size_t u = 0;
    for (; u + 1 < units.size() && bytes >= 1024; ++u) {
        bytes /= 1024;
    }
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g %s", bytes, units[u]);
    return text.data();
}

/// A share in percent.
inline std::string percent_text(double share) { return three_digits(100 * share) + " %"; }

inline std::string time_text(double seconds) { return with_unit(seconds * 1e9, std::array{"ns", "us", "ms", "s"}); }

/// A name as words: `mix_rows<float>` is `mix rows float`, `tokens:64/channels:320` is `tokens 64, channels 320`.
inline std::string words(std::string const& name) {
    std::string text;
    for (auto const letter : name) {
        if (letter == '/') {
            text += ',';
        }
        if (letter != '>') {
            text += letter == '/' || letter == ':' || letter == '_' || letter == '<' ? ' ' : letter;
        }
    }
    return text;
}

/// The list with another item behind a semicolon.
inline void append(std::string& list, std::string const& item) { list += (list.empty() ? "" : "; ") + item; }

/// A counter and its name, which may tell its unit: `held_bytes` is `held 63.2 MB`, `network_seconds` `network 4.60 s`.
inline std::string counter_text(std::string const& name, double value) {
    auto const before = [&name](std::string const& unit) { return words(name.substr(0, name.size() - unit.size())); };
    if (name.ends_with("_bytes")) {
        return before("_bytes") + " " + bytes_text(value);
    }
    if (name.ends_with("_seconds")) {
        return before("_seconds") + " " + time_text(value);
    }
    return words(name) + " " + three_digits(value);
}

} // namespace detail

} // namespace genrender::benchmarks
