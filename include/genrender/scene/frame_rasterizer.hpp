// SPDX-License-Identifier: MIT
// [GR sec. 3] One frame of an animated scene as UV, object, coverage and depth, written through views.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/scene/triangle_coverage.hpp>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace genrender {

/// Where one frame of guidance is written, in its owner's memory.
struct frame_guidance_view {
    strided_view<float, 3> uv;              ///< texture coordinates [height, width, 2]
    strided_view<std::uint32_t, 2> object;  ///< number of the object [height, width]
    strided_view<std::uint8_t, 2> coverage; ///< 1 where the pixel shows an object [height, width]
    strided_view<float, 2> depth;           ///< distance along the view, > 0 where covered [height, width]
    /// Where the point lies in the mesh as it is at rest [height, width, 3], if anybody wants to know.
    std::optional<strided_view<float, 3>> position = {};
};

namespace detail {

using camera_space_triangle = std::array<glm::dvec3, 3>;

/// Pixels that a triangle might cover: rows and columns from first to end.
struct pixel_box {
    std::uint32_t first_row = 0, end_row = 0, first_column = 0, end_column = 0;
};

/// A box around what the image plane sees of the triangle beyond the near distance.
inline pixel_box pixels_around(camera_space_triangle const& corners, image_plane const& plane, double near_distance,
                               grid_extents grid) {
    auto lowest = glm::dvec2(std::numeric_limits<double>::max());
    auto highest = -lowest;
    auto const enclose = [&](glm::dvec3 const& p) {
        auto const position = glm::dvec2(plane.column_of(p.x / -p.z), plane.row_of(p.y / -p.z));
        lowest = glm::min(lowest, position);
        highest = glm::max(highest, position);
    };
    for (std::size_t i = 0; i < 3; ++i) {
        auto const& from = corners[i];
        auto const& to = corners[(i + 1) % 3];
        if (-from.z >= near_distance) {
            enclose(from);
        }
        if ((-from.z >= near_distance) != (-to.z >= near_distance)) {
            auto crossing = from + (to - from) * ((-near_distance - from.z) / (to.z - from.z));
            crossing.z = -near_distance;
            enclose(crossing);
        }
    }
    // One pixel of slack on each side: rounding here must not cost a pixel that the exact test below would cover.
    auto const clamped = [](double position, std::size_t extent) {
        return static_cast<std::uint32_t>(std::clamp(position, 0.0, static_cast<double>(extent)));
    };
    if (!(lowest.x <= highest.x)) {
        return {};
    }
    return {clamped(std::floor(lowest.y) - 1, grid.height), clamped(std::ceil(highest.y) + 1, grid.height),
            clamped(std::floor(lowest.x) - 1, grid.width), clamped(std::ceil(highest.x) + 1, grid.width)};
}

/// Throws unless the object has a surface that can be drawn and one finite position for each of its vertices.
inline void require_drawable(posed_object const& posed) {
    auto const name = "object " + std::to_string(posed.object.value);
    auto const surface_name = name + " surface";
    require_value(posed.surface != nullptr, "rasterize", surface_name.c_str(), "null", "a mesh");
    auto const position_name = name + " positions";
    require_extents("rasterize", position_name.c_str(), std::array{posed.positions.size()},
                    std::array{posed.surface->positions.size()});
    require_finite("rasterize", position_name, std::span<glm::vec3 const>(posed.positions));
    validate(*posed.surface, "rasterize");
}

/// Draws one triangle over what was drawn before: nearest wins, equally near goes to the lower object, then to the
/// earlier triangle.
inline void draw_triangle(frame_guidance_view const& to, std::vector<double>& nearest,
                          camera_space_triangle const& corners, mesh const& surface, glm::uvec3 const& t,
                          object_index object, image_plane const& plane, double near_distance) {
    auto const coverage = triangle_coverage::of(corners);
    if (!coverage) {
        return;
    }
    grid_extents const grid{to.coverage.extent(0), to.coverage.extent(1)};
    auto const box = pixels_around(corners, plane, near_distance, grid);
    for (auto row = box.first_row; row < box.end_row; ++row) {
        for (auto column = box.first_column; column < box.end_column; ++column) {
            auto const weight = coverage->at(plane.centre_of({row, column}));
            if (!weight) {
                continue;
            }
            auto const depth = -(weight->x * corners[0].z + weight->y * corners[1].z + weight->z * corners[2].z);
            auto& best = nearest[row * grid.width + column];
            auto const hidden = depth > best || (depth == best && object >= object_index{to.object(row, column)});
            if (depth < near_distance || hidden) {
                continue;
            }
            best = depth;
            auto const interpolated = [&](auto const& values) {
                using point = glm::vec<std::decay_t<decltype(values[0])>::length(), double>;
                return weight->x * point(values[t.x]) + weight->y * point(values[t.y]) + weight->z * point(values[t.z]);
            };
            auto const uv = interpolated(surface.uvs);
            to.uv(row, column, 0) = static_cast<float>(uv.x);
            to.uv(row, column, 1) = static_cast<float>(uv.y);
            to.object(row, column) = object.value;
            to.coverage(row, column) = 1;
            to.depth(row, column) = static_cast<float>(depth);
            if (to.position) {
                auto const position = interpolated(surface.positions);
                for (glm::length_t axis = 0; axis < 3; ++axis) {
                    (*to.position)(row, column, static_cast<std::size_t>(axis)) = static_cast<float>(position[axis]);
                }
            }
        }
    }
}

} // namespace detail

/// Overwrites one frame with what `scene` shows: UV perspective-correct and as the meshes have it, even outside [0, 1];
/// depth along the viewing axis in scene units; zeros on the background. Pixels are sampled once, at their centre (no
/// antialiasing: a mean of two UVs is a third place). Both sides of a triangle are seen; of equally near surfaces the
/// lower object number wins, then the earlier triangle. Nothing nearer than the camera's near distance is seen, cut per
/// pixel.
///
/// Throws shape_error unless all views have the same height and width and every object has as many positions as
/// its surface; value_error at a camera that cannot see, an object without a surface, positions that are not finite,
/// and as validate(mesh) does.
inline void rasterize_frame(frame_guidance_view const& to, posed_scene const& scene) {
    auto const& extents = to.coverage.extents();
    require_shape("rasterize", "uv", to.uv, {extents[0], extents[1], 2});
    require_shape("rasterize", "object", to.object, extents);
    require_shape("rasterize", "depth", to.depth, extents);
    if (to.position) {
        require_shape("rasterize", "position", *to.position, {extents[0], extents[1], 3});
    }
    validate(scene.camera, "rasterize");
    for (auto const& posed : scene.objects) {
        detail::require_drawable(posed);
    }

    for (std::size_t row = 0; row < extents[0]; ++row) {
        for (std::size_t column = 0; column < extents[1]; ++column) {
            to.uv(row, column, 0) = to.uv(row, column, 1) = to.depth(row, column) = 0;
            to.object(row, column) = 0;
            to.coverage(row, column) = 0;
            for (std::size_t axis = 0; to.position && axis < 3; ++axis) {
                (*to.position)(row, column, axis) = 0;
            }
        }
    }
    std::vector<double> nearest(extents[0] * extents[1], std::numeric_limits<double>::infinity());

    auto const view = glm::dmat4(scene.camera.view);
    image_plane const plane(scene.camera, {extents[0], extents[1]});
    std::vector<glm::dvec3> seen;
    for (auto const& posed : scene.objects) {
        seen.clear();
        for (auto const& p : posed.positions) {
            seen.push_back(glm::dvec3(view * glm::dvec4(p, 1)));
        }
        auto const& surface = *posed.surface;
        for (auto const& t : surface.triangles) {
            detail::draw_triangle(to, nearest, {seen[t.x], seen[t.y], seen[t.z]}, surface, t, posed.object, plane,
                                  static_cast<double>(scene.camera.near_distance));
        }
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
