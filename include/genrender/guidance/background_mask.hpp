// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Which cells of a coarser grid show nothing but background: where its statistics may be taken.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/guidance/uv_maps_view.hpp>

#include <cstddef>
#include <cstdint>

namespace genrender {

/// 1 where no pixel of the cell shows an object, else 0 [frames, height, width of `grid`]. A cell that an object touches is not
/// background, so statistics over the mask hold no object. Throws shape_error unless `grid` divides the maps' height and width.
inline tensor<std::uint8_t, 3> background_mask(uv_maps_view const& maps, grid_extents grid) {
    auto const pixels = maps.grid();
    auto const divides = grid.size() > 0 && pixels.height % grid.height == 0 && pixels.width % grid.width == 0;
    if (!divides) {
        throw shape_error("background_mask: grid is " + extents_text({grid.height, grid.width}) +
                          ", expected divisors of " + extents_text({pixels.height, pixels.width}));
    }
    auto mask = tensor<std::uint8_t, 3>::from_shape({maps.frame_count(), grid.height, grid.width});
    mask.fill(1);
    auto const rows_per_cell = pixels.height / grid.height;
    auto const columns_per_cell = pixels.width / grid.width;
    for (std::uint32_t frame = 0; frame < maps.frame_count(); ++frame) {
        for (std::uint32_t row = 0; row < pixels.height; ++row) {
            for (std::uint32_t column = 0; column < pixels.width; ++column) {
                if (maps.is_covered({frame}, {row, column})) {
                    mask(frame, row / rows_per_cell, column / columns_per_cell) = 0;
                }
            }
        }
    }
    return mask;
}

} // namespace genrender
