// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Which cells of a coarser grid show nothing but background: where its statistics may be taken.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/maps/cell_extents.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace genrender {

/// 1 where no pixel of the cell shows an object, else 0 [frames, height, width of `grid`]. A cell that an object
/// touches is not background, so statistics over the mask hold no object. Throws value_error unless `grid` divides the
/// maps' height and width.
template <canonical_maps Maps>
tensor<std::uint8_t, 3> background_mask(Maps const& maps, grid_extents grid) {
    auto const pixels = maps.grid();
    auto const cell = cell_extents("background_mask", pixels, grid);
    auto mask = tensor<std::uint8_t, 3>::from_shape({maps.frame_count(), grid.height, grid.width});
    mask.fill(1);
    for (std::uint32_t frame = 0; frame < maps.frame_count(); ++frame) {
        for (std::uint32_t row = 0; row < pixels.height; ++row) {
            for (std::uint32_t column = 0; column < pixels.width; ++column) {
                if (maps.is_covered({frame}, {row, column})) {
                    mask(frame, row / cell.height, column / cell.width) = 0;
                }
            }
        }
    }
    return mask;
}

/// Of `background` [frames, height, width], 1 where no object is (background_mask), what is background as far as `distance`
/// rows and columns around, too; beyond the grid counts as background.
inline tensor<std::uint8_t, 3> open_background(strided_view<std::uint8_t const, 3> background, std::size_t distance) {
    auto const [frames, height, width] = background.extents();
    auto along_rows = tensor<std::uint8_t, 3>::from_shape({frames, height, width});
    auto open = tensor<std::uint8_t, 3>::from_shape({frames, height, width});
    for (std::size_t i = 0; i < frames; ++i) {
        for (std::size_t row = 0; row < height; ++row) {
            for (std::size_t column = 0; column < width; ++column) {
                std::uint8_t is_open = 1;
                for (auto c = column - std::min(column, distance); c < std::min(width, column + distance + 1); ++c) {
                    is_open = background(i, row, c) == 0 ? std::uint8_t{0} : is_open;
                }
                along_rows(i, row, column) = is_open;
            }
        }
        for (std::size_t row = 0; row < height; ++row) {
            for (std::size_t column = 0; column < width; ++column) {
                std::uint8_t is_open = 1;
                for (auto r = row - std::min(row, distance); r < std::min(height, row + distance + 1); ++r) {
                    is_open = along_rows(i, r, column) == 0 ? std::uint8_t{0} : is_open;
                }
                open(i, row, column) = is_open;
            }
        }
    }
    return open;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
