// SPDX-License-Identifier: MIT
// A painted, lit picture of one frame of a scene, drawn with the library's rasteriser: what the denoiser learns to
// make.
#pragma once

#include "palette.hpp"
#include "../miniature/random_draw.hpp"
#include "surface_style.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/scene/frame_rasterizer.hpp>
#include <genrender/scene/rasterizer.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/camera.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace genrender::examples {

/// What a scene is painted with. The light comes evenly from above, so that shading belongs to the surface and stays
/// with it when the camera moves.
struct scene_paint {
    std::vector<painted_surface> surfaces;  ///< one for each object
    std::vector<std::uint8_t> is_patterned; ///< one for each object; 0 for the ground
    glm::vec3 horizon;                      ///< colour of the sky low down
    glm::vec3 zenith;                       ///< colour of the sky high up
};

/// Draws the colours of a sky.
inline void draw_sky(random_draw& draw, scene_paint& paint) {
    auto const hue = draw.uniform(0, 1);
    paint.horizon = colour_of(hue, draw.uniform(0.02f, 0.16f), draw.uniform(0.85f, 1));
    paint.zenith = colour_of(hue + draw.uniform(-0.08f, 0.08f), draw.uniform(0.15f, 0.5f), draw.uniform(0.55f, 0.9f));
}

/// Draws the colour of a ground without a pattern.
inline palette draw_ground(random_draw& draw) {
    auto const colour = colour_of(draw.uniform(0, 1), draw.uniform(0.05f, 0.35f), draw.uniform(0.4f, 0.85f));
    return {colour, colour, colour};
}

/// One picture and what belongs to its pixels.
struct lit_picture {
    tensor<float, 3> image;         ///< [3, height, width], red, green and blue in [0, 1]
    tensor<float, 2> pattern_share; ///< [height, width], the share of the pixel that patterned objects fill
    tensor<float, 3>
        inverse_depth; ///< [1, height, width], 1 at the frame's nearest point, 0 at its farthest and in the
                       ///< sky, the mean over the pixel
};

namespace detail {

/// World-space normals of a posed surface, one a vertex: the mean of its triangles', which keeps edges whose sides do
/// not share vertices.
inline std::vector<glm::vec3> posed_normals(posed_object const& posed) {
    std::vector<glm::vec3> normals(posed.positions.size(), glm::vec3(0));
    for (auto const& t : posed.surface->triangles) {
        auto const a = posed.positions[t.x];
        auto const normal = glm::cross(posed.positions[t.y] - a, posed.positions[t.z] - a);
        for (glm::length_t corner = 0; corner < 3; ++corner) {
            normals[t[corner]] += normal;
        }
    }
    for (auto& normal : normals) {
        auto const length = glm::length(normal);
        normal = length > 0 ? normal / length : glm::vec3(0, 1, 0);
    }
    return normals;
}

/// Rest positions, depth and, in place of u, how much each surface faces upwards: what shading reads, in one drawing.
inline rendered_guidance draw_surfaces(posed_scene scene, grid_extents grid) {
    for (auto& posed : scene.objects) {
        auto surface = std::make_shared<mesh>(*posed.surface);
        auto const normals = posed_normals(posed);
        for (std::size_t i = 0; i < surface->uvs.size(); ++i) {
            surface->uvs[i] = {normals[i].y, 0};
        }
        posed.surface = std::move(surface);
    }
    rendered_guidance guidance{uv_maps(1, grid), depth_maps(1, grid),
                               tensor<float, 4>::from_shape({1, grid.height, grid.width, 3})};
    rasterize_frame(frame_view(guidance, {0}), scene);
    guidance.depth.coverage = guidance.uv.coverage;
    return guidance;
}

/// How much light from above reaches points near `target`: the depth map of an eye far over it.
class light_from_above {
public:
    light_from_above(posed_scene scene, glm::vec3 target, float radius) {
        constexpr float height = 60;
        eye_ = look_at(target + glm::vec3(0, height, 0), target, 2 * std::atan(radius / height), {0, 0, -1});
        scene.camera = eye_;
        map_ = depth_maps(1, {resolution, resolution});
        rendered_guidance guidance{uv_maps(1, {resolution, resolution}), map_};
        rasterize_frame(frame_view(guidance, {0}), scene);
        map_.depth = std::move(guidance.depth.depth);
    }

    /// The share of 25 places around the point that see the light, in [0, 1].
    float reaching(glm::vec3 world) const {
        auto const p = glm::vec3(eye_.view * glm::vec4(world, 1));
        image_plane const plane(eye_, {resolution, resolution});
        auto const column = static_cast<int>(std::floor(plane.column_of(static_cast<double>(p.x / -p.z))));
        auto const row = static_cast<int>(std::floor(plane.row_of(static_cast<double>(p.y / -p.z))));
        auto lit = 0;
        for (int down = -2; down <= 2; ++down) {
            for (int right = -2; right <= 2; ++right) {
                auto const i = row + down;
                auto const j = column + right;
                auto const inside = i >= 0 && j >= 0 && i < int{resolution} && j < int{resolution};
                auto const depth =
                    inside ? map_.depth(0, static_cast<std::size_t>(i), static_cast<std::size_t>(j)) : 0.0f;
                lit += depth == 0 || -p.z < depth + 0.12f ? 1 : 0;
            }
        }
        return static_cast<float>(lit) / 25;
    }

private:
    static constexpr std::uint16_t resolution = 128;

    camera eye_;
    depth_maps map_;
};

} // namespace detail

/// The picture of a scene at `grid` pixels, each the mean of `samples` x `samples` points. `shadow_radius` around
/// `target` is where objects throw shadows. Throws as rasterize_frame does, shape_error unless `paint` has one surface
/// an object.
inline lit_picture render_lit(posed_scene const& scene, scene_paint const& paint, grid_extents grid,
                              std::size_t samples, glm::vec3 target, float shadow_radius) {
    require_extents("render_lit", "paint.surfaces", std::array{paint.surfaces.size()},
                    std::array{scene.objects.size()});
    grid_extents const fine{grid.height * static_cast<std::uint32_t>(samples),
                            grid.width * static_cast<std::uint32_t>(samples)};
    std::vector<std::size_t> place_of; // of each object number in the scene
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        auto const number = std::size_t{scene.objects[i].object.value};
        place_of.resize(std::max(place_of.size(), number + 1));
        place_of[number] = i;
    }
    auto const seen = detail::draw_surfaces(scene, fine);
    detail::light_from_above const light(scene, target, shadow_radius);

    image_plane const plane(scene.camera, fine);
    auto const to_world = glm::inverse(scene.camera.view);
    lit_picture picture{tensor<float, 3>::from_shape({3, grid.height, grid.width}),
                        tensor<float, 2>::from_shape({grid.height, grid.width}),
                        cell_means(sequence_inverse_depth(seen.depth), grid)};
    picture.image.fill(0);
    picture.pattern_share.fill(0);
    auto const part = 1 / static_cast<float>(samples * samples);
    for (std::uint32_t row = 0; row < fine.height; ++row) {
        for (std::uint32_t column = 0; column < fine.width; ++column) {
            auto const centre = glm::vec2(plane.centre_of({row, column}));
            auto const ray = glm::vec3(to_world * glm::vec4(centre.x, centre.y, -1, 0));
            auto const height = glm::clamp(glm::normalize(ray).y * 1.8f + 0.08f, 0.0f, 1.0f);
            auto colour = glm::mix(paint.horizon, paint.zenith, height);
            if (seen.uv.coverage(0, row, column) != 0) {
                auto const place = place_of[seen.uv.object(0, row, column)];
                auto const depth = seen.depth.depth(0, row, column);
                auto const rest = glm::vec3(seen.position(0, row, column, 0), seen.position(0, row, column, 1),
                                            seen.position(0, row, column, 2));
                auto up = seen.uv.uv(0, row, column, 0);
                auto const world = glm::vec3(to_world[3]) + ray * depth;
                // Both sides of a plane are seen; light falls on the upper one.
                up = paint.is_patterned[place] != 0 ? up : std::abs(up);
                // Steep surfaces graze the light, and the map of depths is too coarse to say where; they get none of it
                // away.
                auto const facing = glm::smoothstep(0.05f, 0.5f, up);
                auto const lit = 1 - 0.38f * facing * (1 - light.reaching(world));
                auto const shade = (0.42f + 0.58f * (0.5f + 0.5f * up)) * lit;
                colour = glm::mix(paint.surfaces[place].colour_at(rest) * shade, paint.horizon,
                                  paint.is_patterned[place] != 0 ? 0.0f : 1 - std::exp(-depth / 30));
                picture.pattern_share(row / samples, column / samples) += paint.is_patterned[place] != 0 ? part : 0;
            }
            for (std::size_t c = 0; c < 3; ++c) {
                picture.image(c, row / samples, column / samples) += part * colour[static_cast<glm::length_t>(c)];
            }
        }
    }
    return picture;
}

} // namespace genrender::examples
