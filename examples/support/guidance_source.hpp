// SPDX-License-Identifier: MIT
// From a scene's name, a model file or a folder of maps to guidance at full resolution.
#pragma once

#include "../scenes/scenes.hpp"
#include "exr_maps.hpp"
#include "frame_extents.hpp"
#include "model_file.hpp"
#include "padded_maps.hpp"
#include "render_options.hpp"

#include <genrender/scene/rasterizer.hpp>
#include <genrender/maps/uv_convention.hpp>
#include <genrender/maps/uv_report.hpp>
#include <genrender/noise/background_noise.hpp>
#include <genrender/scene/camera.hpp>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// Guidance maps, the extents of the frames to render from them, and what is worth knowing about them.
struct guidance_source {
    rendered_guidance guidance; ///< of the extents that the network renders
    environment_rays rays;      ///< of the scene's cameras; none with maps
    frame_extents extents;
    double frames_per_second = 12; ///< of the moving pictures
    std::vector<std::string> notes;
};

namespace detail {

/// Map pixels along one pixel of a rendered frame, for a model whose tokens have so many along a side: eight a token, and
/// one a pixel at least, since errors are measured between the pixels of frames.
inline std::size_t map_pixels(std::size_t scale) { return std::max<std::size_t>(1, 8 / scale); }

/// The first `count` frames of a stack.
template <class Tensor>
Tensor first_frames(Tensor const& all, std::size_t count) {
    auto shape = all.shape();
    shape[0] = count;
    auto result = Tensor::from_shape(shape);
    std::copy_n(all.data(), result.size(), result.data());
    return result;
}

/// The directions of the cameras' pixels.
template <animation Animation>
environment_rays rays_of(Animation const& scene, grid_extents grid) {
    struct view {
        image_plane plane;
        glm::dmat3 to_world;
    };
    std::vector<view> views;
    for (std::uint32_t i = 0; i < scene.frame_count(); ++i) {
        auto const eye = scene.frame({i}).camera;
        views.push_back({image_plane(eye, grid), glm::dmat3(glm::inverse(eye.view))});
    }
    return {[views = std::move(views)](frame_index i, double row, double column) {
        auto const& [plane, to_world] = views[i.value];
        auto const direction = to_world * glm::dvec3(plane.x_of(column), plane.y_of(row), -1);
        return std::array<double, 3>{direction.x, direction.y, direction.z};
    }};
}

inline void add_notes_on(std::vector<std::string>& notes, uv_report const& report) {
    if (report.out_of_range > 0) {
        notes.push_back(std::to_string(report.out_of_range) + " of " + std::to_string(report.covered) +
                        " covered pixels have UVs outside [0, 1]");
    }
    if (!report.empty_frames.empty()) {
        notes.push_back(std::to_string(report.empty_frames.size()) + " frames show no object");
    }
}

} // namespace detail

/// The guidance that the options ask for, for a model whose tokens have `scale` pixels along a side and that renders whole
/// multiples of `multiple` pixels. Throws file_error for files that cannot be used, value_error for options that do not
/// fit what is read.
inline guidance_source load_guidance(render_options const& options, std::size_t scale, std::size_t multiple,
                                     any_loop const& loop) {
    guidance_source source;
    auto const positions = options.correspondence.coordinates() == canonical_coordinates::position ? position_pass::on
                                                                                                   : position_pass::off;
    auto const& input = options.input;
    auto const draw = [&](auto const& animation, float aspect) {
        auto const width = static_cast<std::size_t>(std::lround(static_cast<float>(options.size) * aspect));
        auto& extents = source.extents;
        extents = extents_of_frames({options.size, options.width.value_or(std::max<std::size_t>(1, width))}, multiple,
                                    detail::map_pixels(scale));
        // Maps of 18 bytes a pixel, 30 with rest positions; a machine that has not as much would be brought down by its
        // own kindness.
        auto const bytes = static_cast<double>(animation.frame_count()) * static_cast<double>(extents.maps().height) *
                           static_cast<double>(extents.maps().width) * (positions == position_pass::on ? 30 : 18);
        auto const memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
        require_value(bytes < memory / 2, "--size", "maps", std::to_string(bytes / 1e9) + " GB",
                      "less than half of the machine's memory: fewer --frames or a smaller --size");
        source.guidance = rasterize(animation, extents.shown_maps(), loop, positions);
        source.rays = detail::rays_of(animation, extents.shown_maps());
    };
    if (!options.scene.empty()) {
        draw(scenes::make_scene(options.scene, options.frames.value_or(24)), 1);
        source.frames_per_second = input.frames_per_second.value_or(source.frames_per_second);
    } else if (!options.model.empty()) {
        std::optional<float> aspect;
        if (options.width) {
            aspect = static_cast<float>(*options.width) / static_cast<float>(options.size);
        }
        auto const model = load_model(options.model, input.of_model(options.frames, aspect));
        source.notes = lines_of(model.report());
        source.frames_per_second = model.frames_per_second();
        draw(model, model.aspect());
    } else {
        require_value(options.settings.noise.background != background_noise::environment, "--background", "environment",
                      "of EXR maps", "fixed or independent: cameras come with --scene and --model");
        auto sequence = load_exr_sequence(options.maps);
        source.notes = std::move(sequence.notes);
        require_value(positions == position_pass::off || sequence.position.shape()[0] > 0, "--canonical", "position",
                      "not in the EXR files", "channels LAYER.Rest.X, Y and Z (or Blender's Position pass)");
        source.guidance.uv = std::move(sequence.uv);
        source.guidance.depth = std::move(sequence.depth);
        auto& uv = source.guidance.uv;
        auto& depth = source.guidance.depth;
        auto const count = std::min(options.frames.value_or(uv.frame_count()), uv.frame_count());
        uv.uv = detail::first_frames(uv.uv, count);
        uv.object = detail::first_frames(uv.object, count);
        uv.coverage = detail::first_frames(uv.coverage, count);
        depth.depth = detail::first_frames(depth.depth, count);
        depth.coverage = uv.coverage;
        if (positions == position_pass::on) {
            source.guidance.position = detail::first_frames(sequence.position, count);
        }
        source.frames_per_second = input.frames_per_second.value_or(source.frames_per_second);
        source.extents = extents_over_maps(uv.grid(), options.size, options.width, multiple);
    }
    source.guidance = with_extents(std::move(source.guidance), source.extents.maps());
    if (auto note = note_on(source.extents, options.size); !note.empty()) {
        source.notes.push_back(std::move(note));
    }
    detail::add_notes_on(source.notes, inspect(to_uv_view(source.guidance.uv)));
    // Texels have nowhere else to go; a footprint tells the tiles of a repeated texture apart.
    auto const& settings = options.settings;
    auto const has_texels = settings.correspondence.kind == correspondence_kind::texel_grid ||
                            settings.noise.reading != noise_reading::surface;
    if (has_texels && !options.is_check) { // a check tells of what it finds
        adopt_uv(to_view(source.guidance.uv.uv), to_view(source.guidance.uv.coverage), {.outside = uv_outside::wrap});
    }
    return source;
}

} // namespace genrender::examples
