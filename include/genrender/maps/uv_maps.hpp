// SPDX-License-Identifier: MIT
// [GR sec. 3] UV maps of an animation: for every pixel of every frame, which object it shows and where on its texture.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/uv_maps_view.hpp>

#include <cstdint>

namespace genrender {

/// UV, object and coverage of every pixel of an animation, as a renderer without antialiasing writes them.
struct uv_maps {
    tensor<float, 4> uv; ///< texture coordinates (u, v) [frames, height, width, 2]; (0, 0) is the first texel's corner
    tensor<std::uint32_t, 3> object; ///< number of the object [frames, height, width]; meaningless where not covered
    tensor<std::uint8_t, 3>
        coverage; ///< 1 where the pixel shows an object, 0 on the background [frames, height, width]

    uv_maps() = default;

    /// Maps of `frames` frames that show nothing yet.
    uv_maps(std::size_t frames, grid_extents grid)
        : uv(tensor<float, 4>::from_shape({frames, grid.height, grid.width, 2})),
          object(tensor<std::uint32_t, 3>::from_shape({frames, grid.height, grid.width})),
          coverage(tensor<std::uint8_t, 3>::from_shape({frames, grid.height, grid.width})) {
        uv.fill(0);
        object.fill(0);
        coverage.fill(0);
    }

    /// Number of frames.
    std::size_t frame_count() const { return coverage.shape()[0]; }
    /// Height and width of a frame in pixels.
    grid_extents grid() const { return {coverage.shape()[1], coverage.shape()[2]}; }
};

/// The read-only view that correspondence and noise take; throws shape_error if the three maps differ in extents.
inline uv_maps_view to_uv_view(uv_maps const& maps) {
    return uv_maps_view(to_view(maps.uv), to_view(maps.object), to_view(maps.coverage));
}

} // namespace genrender

#include <genrender/core/end_header.inl>
