// SPDX-License-Identifier: MIT
// UV maps written as pictures: a letter names the object of a map pixel, a point is background.
#pragma once

#include <genrender/maps/uv_maps.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace genrender::testing {

/// Maps of the frames drawn in `pictures`, rows separated by spaces: 'a' is object 0, 'b' object 1. Texture coordinates
/// are those of the pixel's place in the picture.
inline uv_maps drawn_maps(std::vector<std::string> const& pictures) {
    auto const width = pictures.front().find(' ');
    auto const row_length = width == std::string::npos ? pictures.front().size() : width;
    auto const height = (pictures.front().size() + 1) / (row_length + 1);
    uv_maps maps(pictures.size(), {height, row_length});
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        for (std::size_t row = 0; row < height; ++row) {
            for (std::size_t column = 0; column < row_length; ++column) {
                auto const letter = pictures[i][row * (row_length + 1) + column];
                maps.coverage(i, row, column) = letter != '.';
                maps.object(i, row, column) = letter != '.' ? static_cast<std::uint32_t>(letter - 'a') : 0U;
                maps.uv(i, row, column, 0) = (static_cast<float>(column) + 0.5F) / static_cast<float>(row_length);
                maps.uv(i, row, column, 1) = (static_cast<float>(row) + 0.5F) / static_cast<float>(height);
            }
        }
    }
    return maps;
}

} // namespace genrender::testing
