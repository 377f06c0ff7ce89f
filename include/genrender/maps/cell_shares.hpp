// SPDX-License-Identifier: MIT
// How much of each cell of a coarser grid shows the object that the cell stands for: little at silhouettes.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/maps/cell_extents.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace genrender {

/// The share of each cell's pixels that show the object which most of them show, in 255ths [frames, height, width of
/// `grid`]: 255 inside of an object, less where another object or the background begins, 0 on the background. Throws
/// value_error unless `grid` divides the maps' height and width.
template <canonical_maps Maps>
tensor<std::uint8_t, 3> cell_shares(Maps const& maps, grid_extents grid) {
    auto const cell = cell_extents("cell_shares", maps.grid(), grid);
    auto shares = tensor<std::uint8_t, 3>::from_shape({maps.frame_count(), grid.height, grid.width});
    std::vector<std::pair<object_index, std::size_t>> owned; // pixels by object; a cell seldom shows more than two
    for (std::uint32_t frame = 0; frame < maps.frame_count(); ++frame) {
        for (std::size_t token = 0; token < grid.size(); ++token) {
            owned.clear();
            std::size_t most = 0;
            for (std::size_t e = 0; e < cell.size(); ++e) {
                pixel const at{static_cast<std::uint32_t>(token / grid.width * cell.height + e / cell.width),
                               static_cast<std::uint32_t>(token % grid.width * cell.width + e % cell.width)};
                if (!maps.is_covered({frame}, at)) {
                    continue;
                }
                auto const object = maps.object_at({frame}, at);
                auto known =
                    std::find_if(owned.begin(), owned.end(), [&](auto const& one) { return one.first == object; });
                if (known == owned.end()) {
                    known = owned.insert(known, {object, 0});
                }
                most = std::max(most, ++known->second);
            }
            shares(frame, token / grid.width, token % grid.width) =
                static_cast<std::uint8_t>((255 * most + cell.size() / 2) / cell.size());
        }
    }
    return shares;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
