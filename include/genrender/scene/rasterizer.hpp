// SPDX-License-Identifier: MIT
// [GR sec. 3] From an animated scene to its guidance: UV maps and depth maps of every frame.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/scene/frame_rasterizer.hpp>
#include <genrender/maps/uv_maps.hpp>
#include <genrender/scene/animation.hpp>

#include <cstddef>
#include <cstdint>

namespace genrender {

/// What a scene gives to the generator: where every pixel lies on its object's texture, and how far away it is.
struct rendered_guidance {
    uv_maps uv;       ///< texture coordinates, object and coverage of every pixel
    depth_maps depth; ///< distance and coverage of every pixel
    /// Where every pixel lies on its object at rest, in the mesh's units [frames, height, width, 3]; without frames
    /// unless position_pass::on.
    tensor<float, 4> position = tensor<float, 4>::from_shape({0, 0, 0, 3});
};

/// Whether the rasteriser also writes rest positions.
enum class position_pass : std::uint8_t {
    off, ///< UV and depth maps alone
    on   ///< rest positions too
};

/// The rest positions of `guidance` as canonical maps. Throws shape_error if they were not written.
inline position_maps_view to_position_view(rendered_guidance const& guidance) {
    return position_maps_view(to_view(guidance.position), to_view(guidance.uv.object), to_view(guidance.uv.coverage));
}

/// The views of one frame of `guidance`. Throws value_error if there is no such frame.
inline frame_guidance_view frame_view(rendered_guidance& guidance, frame_index i) {
    require_value(i.value < guidance.uv.frame_count(), "frame_view", "i", i.value, "a frame of the guidance");
    frame_guidance_view frame{to_view(guidance.uv.uv)[i.value], to_view(guidance.uv.object)[i.value],
                              to_view(guidance.uv.coverage)[i.value], to_view(guidance.depth.depth)[i.value]};
    if (guidance.position.shape()[0] > 0) {
        frame.position = to_view(guidance.position)[i.value];
    }
    return frame;
}

/// UV and depth maps, and rest positions if asked, of all frames of `scene` at `grid` pixels; each frame as
/// rasterize_frame draws it. Frames run through `loop` and do not depend on its threads. Throws value_error at a grid
/// without pixels, and as rasterize_frame does.
template <animation Animation>
rendered_guidance rasterize(Animation const& scene, grid_extents grid, any_loop const& loop = {},
                            position_pass positions = position_pass::off) {
    require_value(grid.size() > 0, "rasterize", "grid", extents_text({grid.height, grid.width}), "at least one pixel");
    std::size_t const frames = scene.frame_count();
    rendered_guidance guidance{uv_maps(frames, grid), depth_maps(frames, grid)};
    if (positions == position_pass::on) {
        guidance.position = tensor<float, 4>::from_shape({frames, grid.height, grid.width, 3});
    }
    loop(frames, [&](std::size_t frame) {
        frame_index const i{static_cast<std::uint32_t>(frame)};
        rasterize_frame(frame_view(guidance, i), scene.frame(i));
    });
    guidance.depth.coverage = guidance.uv.coverage;
    return guidance;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
