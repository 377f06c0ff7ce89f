// SPDX-License-Identifier: MIT
// Tables of text for a person to read.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace genrender::examples {

/// Rows of cells as lines of text: columns as wide as their widest cell, two spaces apart, aligned to the right but for
/// the first. Every row has the cells of the first, which is the head.
inline std::string table_text(std::vector<std::vector<std::string>> const& rows) {
    std::vector<std::size_t> widths;
    for (auto const& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t c = 0; c < row.size(); ++c) {
            widths[c] = std::max(widths[c], row[c].size());
        }
    }
    std::string text;
    for (auto const& row : rows) {
        std::string line = "  ";
        for (std::size_t c = 0; c < row.size(); ++c) {
            std::string const room(widths[c] - row[c].size(), ' ');
            line += (c > 0 ? "  " : "") + (c == 0 ? row[c] + room : room + row[c]);
        }
        text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
}

/// A number with so many digits after the point.
inline std::string fixed_text(double value, int digits) {
    std::array<char, 48> text{};
    std::snprintf(text.data(), text.size(), "%.*f", digits, value);
    return text.data();
}

} // namespace genrender::examples
