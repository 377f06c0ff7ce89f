// SPDX-License-Identifier: MIT
// [GR sec. 3] The cell of full-resolution map pixels that lies under one token or latent pixel.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>

#include <cstddef>
#include <string>

namespace genrender {

/// Height and width, in map pixels, of the cell under one token of a coarser grid. Throws value_error, in the name of
/// `function`, unless the map's extents are whole multiples of the grid's.
inline grid_extents cell_extents(char const* function, grid_extents map, grid_extents grid) {
    auto const divides = [](std::size_t whole, std::size_t part) { return whole > 0 && part > 0 && whole % part == 0; };
    if (!divides(map.height, grid.height) || !divides(map.width, grid.width)) {
        throw value_error(std::string(function) + ": grid is " + extents_text({grid.height, grid.width}) +
                          ", expected extents that divide the maps' " + extents_text({map.height, map.width}));
    }
    return {map.height / grid.height, map.width / grid.width};
}

} // namespace genrender

#include <genrender/core/end_header.inl>
