// SPDX-License-Identifier: MIT
// A scene to compare methods on: its guidance, its true correspondences, and what it looks like when it is painted.
#pragma once

#include <examples/reference_denoiser/lit_render.hpp>
#include <examples/reference_denoiser/palette.hpp>
#include <examples/reference_denoiser/random_draw.hpp>
#include <examples/reference_denoiser/surface_style.hpp>
#include <examples/scenes/scenes.hpp>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/evaluation/pixel_correspondence.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/scene/rasterizer.hpp>
#include <genrender/maps/uv_maps_view.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// Whether an object is more than the ground, which is number 0 in the built-in scenes.
inline bool stands_out(object_index object) { return object.value != 0; }

/// An animation through a longer lens: the middle `share` of its pictures' height and width, in (0, 1]. A model of
/// animation.
class close_up {
public:
    close_up(scenes::any_animation scene, float share) : scene_(std::move(scene)), share_(share) {}

    std::size_t frame_count() const { return scene_.frame_count(); }
    posed_scene frame(frame_index i) const {
        auto posed = scene_.frame(i);
        posed.camera.vertical_fov = 2 * std::atan(share_ * std::tan(posed.camera.vertical_fov / 2));
        return posed;
    }

private:
    scenes::any_animation scene_;
    float share_;
};

/// A built-in scene as it is compared: so close that patterns as coarse as a small image needs still repeat on its
/// objects, and with a camera that goes around no faster than 5 degrees a frame at 24 frames, so that frames 20 apart
/// still show some of the same surfaces. Throws as make_scene does.
inline scenes::any_animation compared_animation(std::string const& name, std::size_t frames) {
    if (name == "camera_rotation") {
        return scenes::any_animation(
            close_up(scenes::any_animation(scenes::camera_rotation(frames, glm::radians(120.0f))), 0.6f));
    }
    return scenes::any_animation(close_up(scenes::make_scene(name, frames), name == "bouncing_balls" ? 0.5f : 0.8f));
}

/// One of the built-in scenes, rasterised at four times the size of its images. None of them can be drawn as a scene of
/// the training data: spheres, cylinders and capsules do not occur there, nor does the mannequin, nor any motion.
struct evaluation_scene {
    std::string name;
    scenes::any_animation animation;
    grid_extents image;
    rendered_guidance guidance;
    tensor<float, 3> inverse_depth; ///< [frames, height, width] of the images, in [0, 1]
    pixel_correspondence pixels;    ///< what errors are measured at

    std::size_t frame_count() const { return animation.frame_count(); }
    uv_maps_view uv() const { return to_uv_view(guidance.uv); }
};

/// The built-in scene `name` in `frames` frames of `image` pixels. Throws as make_scene and rasterize do.
inline evaluation_scene make_evaluation_scene(std::string const& name, std::size_t frames, grid_extents image,
                                              any_loop const& loop) {
    auto animation = compared_animation(name, frames);
    grid_extents const fine{4 * image.height, 4 * image.width};
    auto guidance = rasterize(animation, fine, loop);
    auto inverse_depth = cell_means(sequence_inverse_depth(guidance.depth), image);
    pixel_correspondence pixels(to_uv_view(guidance.uv), image, 0.25, loop);
    return {name, std::move(animation), image, std::move(guidance), std::move(inverse_depth), std::move(pixels)};
}

/// The middle of the box around all that stands out, and half its diagonal.
inline std::pair<glm::vec3, float> middle_and_radius(posed_scene const& scene) {
    auto lower = glm::vec3(std::numeric_limits<float>::max());
    auto upper = -lower;
    for (auto const& posed : scene.objects) {
        if (stands_out(posed.object)) {
            for (auto const& p : posed.positions) {
                lower = glm::min(lower, p);
                upper = glm::max(upper, p);
            }
        }
    }
    return {(lower + upper) * 0.5f, glm::distance(lower, upper) / 2};
}

/// The median depth of what stands out in the first frame.
inline float middle_depth(evaluation_scene const& scene) {
    std::vector<float> depths;
    auto const& maps = scene.guidance;
    for (std::size_t row = 0; row < maps.uv.grid().height; ++row) {
        for (std::size_t column = 0; column < maps.uv.grid().width; ++column) {
            if (maps.uv.coverage(0, row, column) != 0 && stands_out({maps.uv.object(0, row, column)})) {
                depths.push_back(maps.depth.depth(0, row, column));
            }
        }
    }
    require_value(!depths.empty(), "painted_frames", "scene", scene.name, "something besides the ground in frame 0");
    auto const middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    return *middle;
}

/// A style on all objects of a scene, in a palette that training never showed: images [frames, 3, height, width]. The
/// same seed paints the same surfaces in the same way, so that only light and view change from frame to frame.
inline tensor<float, 4> painted_frames(evaluation_scene const& scene, surface_style style, std::uint64_t seed,
                                       any_loop const& loop) {
    auto const first = scene.animation.frame({0});
    random_draw draw(seed, 0);
    scene_paint paint;
    // Features as large as in the training data: 7 to 10 pixels of 64, where half of what stands out is nearer.
    auto const pixel_size = 2 * std::tan(first.camera.vertical_fov / 2) * middle_depth(scene) / 64;
    auto const feature = pixel_size * draw.uniform(7, 10);
    auto const colours = draw_palette(draw, {}, palette_set::held_out);
    for (auto const& posed : first.objects) {
        auto const is_ground = !stands_out(posed.object);
        paint.surfaces.emplace_back(draw, is_ground ? surface_style::plain : style,
                                    is_ground ? draw_ground(draw) : colours, *posed.surface, feature);
        paint.is_patterned.push_back(is_ground ? 0 : 1);
    }
    draw_sky(draw, paint);
    auto images = tensor<float, 4>::from_shape({scene.frame_count(), 3, scene.image.height, scene.image.width});
    loop(scene.frame_count(), [&](std::size_t i) {
        auto const posed = scene.animation.frame({static_cast<std::uint32_t>(i)});
        auto const [target, reach] = middle_and_radius(posed);
        auto const picture = render_lit(posed, paint, scene.image, 3, target, 1.6f * reach);
        copy(to_view(images)[i], to_view(picture.image));
    });
    return images;
}

} // namespace genrender::examples
