// SPDX-License-Identifier: MIT
// A painted, lit picture of one frame of a scene, drawn with the library's rasteriser: what the miniature learns to make.
#pragma once

#include "surface_paint.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/camera.hpp>
#include <genrender/scene/frame_rasterizer.hpp>
#include <genrender/scene/rasterizer.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace genrender::examples::miniature {

/// What a scene is painted with. The light comes evenly from above, so that shading belongs to the surface and stays
/// with it when the camera moves.
struct picture_paint {
    std::vector<surface_paint> surfaces;  ///< one for each object
    std::vector<std::uint8_t> is_subject; ///< one for each object; 0 for grounds and walls
    glm::vec3 horizon{1};                 ///< colour of the sky low down
    glm::vec3 zenith{1};                  ///< colour of the sky high up
    glm::vec3 tint{1};                    ///< colour of the light
    float clouds = 0;                     ///< how white the clouds are, in [0, 1]
    std::uint32_t cloud_seed = 0;
    float clear_distance = 40; ///< where 1 / e of a ground is still seen through the air, scene units
};

/// One picture and what belongs to its pixels.
struct lit_picture {
    tensor<float, 3> image;         ///< [3, height, width], red, green and blue in [0, 1]
    tensor<float, 2> subject_share; ///< [height, width], the share of the pixel that subjects fill
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

/// Rest positions, depth and, in place of (u, v), how much each surface faces upwards and the eye: what shading reads,
/// in one drawing.
inline rendered_guidance draw_surfaces(posed_scene scene, grid_extents grid) {
    auto const eye = position_of(scene.camera);
    for (auto& posed : scene.objects) {
        auto surface = std::make_shared<mesh>(*posed.surface);
        auto const normals = posed_normals(posed);
        for (std::size_t i = 0; i < surface->uvs.size(); ++i) {
            auto const way = eye - posed.positions[i];
            surface->uvs[i] = {normals[i].y, std::abs(glm::dot(normals[i], way)) / std::max(glm::length(way), 1e-6f)};
        }
        posed.surface = std::move(surface);
    }
    rendered_guidance guidance{uv_maps(1, grid), depth_maps(1, grid),
                               tensor<float, 4>::from_shape({1, grid.height, grid.width, 3})};
    rasterize_frame(frame_view(guidance, {0}), scene);
    guidance.depth.coverage = guidance.uv.coverage;
    return guidance;
}

/// How much light from above reaches points near `target` past the subjects: the depth map of an eye far over it.
class light_from_above {
public:
    light_from_above(posed_scene const& scene, picture_paint const& paint, glm::vec3 target, float radius) {
        constexpr float height = 60;
        eye_ = look_at(target + glm::vec3(0, height, 0), target, 2 * std::atan(radius / height), {0, 0, -1});
        posed_scene subjects{eye_, {}};
        for (std::size_t i = 0; i < scene.objects.size(); ++i) {
            if (paint.is_subject[i] != 0) {
                subjects.objects.push_back(scene.objects[i]);
            }
        }
        map_ = depth_maps(1, {resolution, resolution});
        rendered_guidance guidance{uv_maps(1, {resolution, resolution}), map_};
        rasterize_frame(frame_view(guidance, {0}), subjects);
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

/// The colour of the sky along a ray.
inline glm::vec3 sky_colour(picture_paint const& paint, glm::vec3 ray) {
    auto const way = glm::normalize(ray);
    auto const height = glm::clamp(way.y * 1.8f + 0.08f, 0.0f, 1.0f);
    auto const colour = glm::mix(paint.horizon, paint.zenith, height);
    if (paint.clouds == 0) {
        return colour;
    }
    auto const place = way * glm::vec3(5, 11, 5);
    auto const thickness =
        gradient_noise(paint.cloud_seed, place) + 0.4f * gradient_noise(paint.cloud_seed + 1, place * 2.3f);
    return glm::mix(colour, glm::vec3(1), paint.clouds * glm::smoothstep(0.0f, 0.25f, thickness));
}

} // namespace detail

/// The picture of a scene at `grid` pixels, each the mean of `samples` x `samples` points. `shadow_radius` around
/// `target` is where subjects throw shadows. Throws as rasterize_frame does, shape_error unless `paint` has one surface
/// an object.
inline lit_picture draw_lit(posed_scene const& scene, picture_paint const& paint, grid_extents grid,
                            std::size_t samples, glm::vec3 target, float shadow_radius) {
    require_extents("draw_lit", "paint.surfaces", std::array{paint.surfaces.size()}, std::array{scene.objects.size()});
    require_extents("draw_lit", "paint.is_subject", std::array{paint.is_subject.size()},
                    std::array{scene.objects.size()});
    grid_extents const fine{grid.height * samples, grid.width * samples};
    std::vector<std::size_t> place_of; // of each object number in the scene
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        auto const number = std::size_t{scene.objects[i].object.value};
        place_of.resize(std::max(place_of.size(), number + 1));
        place_of[number] = i;
    }
    auto const seen = detail::draw_surfaces(scene, fine);
    detail::light_from_above const light(scene, paint, target, shadow_radius);

    image_plane const plane(scene.camera, fine);
    auto const to_world = glm::inverse(scene.camera.view);
    auto const pixel_at_one = 2 * std::tan(scene.camera.vertical_fov / 2) / static_cast<float>(grid.height);
    lit_picture picture{tensor<float, 3>::from_shape({3, grid.height, grid.width}),
                        tensor<float, 2>::from_shape({grid.height, grid.width}),
                        cell_means(sequence_inverse_depth(seen.depth), grid)};
    picture.image.fill(0);
    picture.subject_share.fill(0);
    auto const part = 1 / static_cast<float>(samples * samples);
    for (std::size_t row = 0; row < fine.height; ++row) {
        for (std::size_t column = 0; column < fine.width; ++column) {
            auto const centre =
                glm::vec2(plane.centre_of({static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column)}));
            auto const ray = glm::vec3(to_world * glm::vec4(centre.x, centre.y, -1, 0));
            glm::vec3 colour;
            if (seen.uv.coverage(0, row, column) != 0) {
                auto const place = place_of[seen.uv.object(0, row, column)];
                auto const is_subject = paint.is_subject[place] != 0;
                auto const depth = seen.depth.depth(0, row, column);
                auto const rest = glm::vec3(seen.position(0, row, column, 0), seen.position(0, row, column, 1),
                                            seen.position(0, row, column, 2));
                auto up = seen.uv.uv(0, row, column, 0);
                auto const facing_eye = seen.uv.uv(0, row, column, 1);
                auto const world = glm::vec3(to_world[3]) + ray * depth;
                // Both sides of a plane are seen; light falls on the upper one.
                up = is_subject ? up : std::abs(up);
                // Steep surfaces graze the light, and the map of depths is too coarse to say where; they get none of it
                // away.
                auto const facing = glm::smoothstep(0.05f, 0.5f, up);
                auto const lit = 1 - 0.4f * facing * (1 - light.reaching(world));
                auto const shade = (0.45f + 0.55f * (0.5f + 0.5f * up)) * lit * (0.84f + 0.16f * facing_eye);
                auto const& surface = paint.surfaces[place];
                // Features of a ground that the eye sees too small melt into their mean.
                auto const wide = surface.feature() / (pixel_at_one * depth) * (is_subject ? 1.0f : facing_eye);
                auto const contrast = is_subject ? 1.0f : glm::smoothstep(1.5f, 5.0f, wide);
                colour = surface.colour_at(rest, contrast) * shade * paint.tint;
                colour =
                    glm::mix(colour, paint.horizon, is_subject ? 0.0f : 1 - std::exp(-depth / paint.clear_distance));
                picture.subject_share(row / samples, column / samples) += is_subject ? part : 0;
            } else {
                colour = detail::sky_colour(paint, ray);
            }
            colour = glm::clamp(colour, 0.0f, 1.0f);
            for (std::size_t c = 0; c < 3; ++c) {
                picture.image(c, row / samples, column / samples) += part * colour[static_cast<glm::length_t>(c)];
            }
        }
    }
    return picture;
}

} // namespace genrender::examples::miniature
