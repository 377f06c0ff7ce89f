// SPDX-License-Identifier: MIT
// [GR sec. 3] Depth maps of an animation, and the sequence-wide inverse depth that depth-conditioned networks take.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/cell_extents.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace genrender {

/// Distance from the camera plane to what each pixel shows, in scene units.
struct depth_maps {
    tensor<float, 3> depth;           ///< > 0 where covered [frames, height, width]; meaningless elsewhere
    tensor<std::uint8_t, 3> coverage; ///< 1 where the pixel shows a surface [frames, height, width]

    depth_maps() = default;

    /// Maps of `frames` frames that show nothing yet.
    depth_maps(std::size_t frames, grid_extents grid)
        : depth(tensor<float, 3>::from_shape({frames, grid.height, grid.width})),
          coverage(tensor<std::uint8_t, 3>::from_shape({frames, grid.height, grid.width})) {
        depth.fill(0);
        coverage.fill(0);
    }

    /// Number of frames.
    std::size_t frame_count() const { return depth.shape()[0]; }
    /// Height and width of a frame in pixels.
    grid_extents grid() const { return {depth.shape()[1], depth.shape()[2]}; }
};

/// Inverse depth of the whole sequence on one scale [frames, height, width]: 1 at the nearest covered pixel of the
/// animation, 0 at the farthest and on the background; all covered pixels are 1 if they are equally far. One scale for
/// all frames, because a scale per frame flickers. Throws shape_error if the two maps differ, value_error
/// at a covered depth that is not finite and > 0.
inline tensor<float, 3> sequence_inverse_depth(depth_maps const& maps) {
    require_extents("sequence_inverse_depth", "maps.depth", maps.depth.shape(), maps.coverage.shape());
    auto nearest = 0.0f;
    auto farthest = std::numeric_limits<float>::max();
    auto const* const depth = maps.depth.data();
    auto const* const covered = maps.coverage.data();
    for (std::size_t i = 0; i < maps.depth.size(); ++i) {
        if (covered[i] == 0) {
            continue;
        }
        require_value(is_finite(depth[i]) && depth[i] > 0, "sequence_inverse_depth", "maps.depth", depth[i],
                      "finite depths above 0 where covered");
        nearest = std::max(nearest, 1 / depth[i]);
        farthest = std::min(farthest, 1 / depth[i]);
    }
    auto const range = nearest - farthest;
    auto result = tensor<float, 3>::from_shape(maps.depth.shape());
    for (std::size_t i = 0; i < result.size(); ++i) {
        result.data()[i] = covered[i] == 0 ? 0.0f : range > 0 ? (1 / depth[i] - farthest) / range : 1.0f;
    }
    return result;
}

/// Means of `map` [frames, height, width] over the cells of a coarser grid [frames, height, width of `grid`]: inverse
/// depth at the size that a network's hint has. Throws value_error unless the grid divides the map.
inline tensor<float, 3> cell_means(tensor<float, 3> const& map, grid_extents grid) {
    auto const cell = cell_extents("cell_means", {map.shape()[1], map.shape()[2]}, grid);
    auto means = tensor<float, 3>::from_shape({map.shape()[0], grid.height, grid.width});
    for (std::size_t frame = 0; frame < map.shape()[0]; ++frame) {
        for (std::size_t row = 0; row < grid.height; ++row) {
            for (std::size_t column = 0; column < grid.width; ++column) {
                float sum = 0;
                for (std::size_t p = 0; p < cell.size(); ++p) {
                    sum += map(frame, row * cell.height + p / cell.width, column * cell.width + p % cell.width);
                }
                means(frame, row, column) = sum / static_cast<float>(cell.size());
            }
        }
    }
    return means;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
