// SPDX-License-Identifier: MIT
// From a scene's name, a model file or a folder of maps to guidance at full resolution.
#pragma once

#include "../scenes/scenes.hpp"
#include "exr_maps.hpp"
#include "model_file.hpp"
#include "render_options.hpp"

#include <genrender/guidance/rasterizer.hpp>
#include <genrender/guidance/uv_convention.hpp>
#include <genrender/guidance/uv_report.hpp>

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// Guidance maps, the extents of the frames to render from them, and what is worth knowing about them.
struct guidance_source {
    rendered_guidance guidance;
    grid_extents image;
    std::vector<std::string> notes;
};

namespace detail {

/// Map pixels along one pixel of a rendered frame: correspondences are found between the pixels of the frame.
inline constexpr std::size_t map_pixels = 4;

/// The first `count` frames of a stack.
template <class Tensor>
Tensor first_frames(Tensor const& all, std::size_t count) {
    auto shape = all.shape();
    shape[0] = count;
    auto result = Tensor::from_shape(shape);
    std::copy_n(all.data(), result.size(), result.data());
    return result;
}

/// Whole frames of `size` pixels of height that show maps of `grid`. Throws value_error if pixels would be cut.
inline grid_extents image_extents(grid_extents grid, std::size_t size) {
    require_value(size <= grid.height && grid.height % size == 0 && grid.width % (grid.height / size) == 0, "--size",
                  "height", size, ("a divisor of the maps' " + extents_text({grid.height, grid.width})).c_str());
    return {size, grid.width / (grid.height / size)};
}

inline void add_notes_on(std::vector<std::string>& notes, uv_report const& report) {
    if (report.out_of_range > 0) {
        notes.push_back(std::to_string(report.out_of_range) + " of " + std::to_string(report.covered) +
                        " covered pixels have UVs outside [0, 1]; their texture is taken to repeat");
    }
    if (!report.empty_frames.empty()) {
        notes.push_back(std::to_string(report.empty_frames.size()) + " frames show no object");
    }
}

} // namespace detail

/// The guidance that the options ask for. Throws file_error for files that cannot be used, value_error for options that
/// do not fit what is read.
template <parallel_loop Loop>
guidance_source load_guidance(render_options const& options, Loop const& loop) {
    guidance_source source;
    auto const frames = options.frames.value_or(24);
    source.image = {options.size, options.size};
    grid_extents const map{detail::map_pixels * options.size, detail::map_pixels * options.size};
    // Maps of 18 bytes a pixel; a machine that has not as much would be brought down by its own kindness.
    auto const bytes =
        static_cast<double>(frames) * static_cast<double>(map.height) * static_cast<double>(map.width) * 18;
    auto const memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    require_value(!options.maps.empty() || bytes < memory / 2, "--size", "maps", std::to_string(bytes / 1e9) + " GB",
                  "less than half of the machine's memory: fewer --frames or a smaller --size");
    if (!options.scene.empty()) {
        source.guidance = rasterize(scenes::make_scene(options.scene, frames), map, loop);
    } else if (!options.model.empty()) {
        auto const model = load_model(options.model, {.frames = frames});
        source.notes = lines_of(model.report());
        source.guidance = rasterize(model, map, loop);
    } else {
        auto sequence = load_exr_sequence(options.maps);
        source.notes = std::move(sequence.notes);
        source.guidance = {std::move(sequence.uv), std::move(sequence.depth)};
        auto& [uv, depth] = source.guidance;
        auto const count = std::min(options.frames.value_or(uv.frame_count()), uv.frame_count());
        uv.uv = detail::first_frames(uv.uv, count);
        uv.object = detail::first_frames(uv.object, count);
        uv.coverage = detail::first_frames(uv.coverage, count);
        depth.depth = detail::first_frames(depth.depth, count);
        depth.coverage = uv.coverage;
        source.image = detail::image_extents(uv.grid(), options.size);
    }
    detail::add_notes_on(source.notes, inspect(to_uv_view(source.guidance.uv)));
    adopt_uv(to_view(source.guidance.uv.uv), to_view(source.guidance.uv.coverage), {.outside = uv_outside::wrap});
    return source;
}

} // namespace genrender::examples
