// SPDX-License-Identifier: MIT
// A scene to compare methods on: its guidance, its true correspondences, and what it looks like when it is painted.
#pragma once

#include "caption.hpp"
#include "development_world.hpp"

#include <examples/miniature/lit_picture.hpp>
#include <examples/miniature/surface_paint.hpp>
#include <examples/miniature/world_colours.hpp>
#include <examples/miniature/world_scene.hpp>
#include <examples/scenes/scenes.hpp>
#include <examples/support/guidance_source.hpp>

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

/// The first frames of a longer animation. A model of animation.
class first_frames {
public:
    first_frames(scenes::any_animation scene, std::size_t frames) : scene_(std::move(scene)), frames_(frames) {}

    std::size_t frame_count() const { return frames_; }
    posed_scene frame(frame_index i) const { return scene_.frame(i); }

private:
    scenes::any_animation scene_;
    std::size_t frames_;
};

/// A built-in scene as it is compared: so close that patterns as coarse as a small image needs still repeat on its
/// objects, and as fast for any number of frames: 24 a second, the camera goes around by 5 degrees a frame. Throws as
/// make_scene does.
inline scenes::any_animation compared_animation(std::string const& name, std::size_t frames) {
    auto const is_rotation = name == "camera_rotation";
    auto const whole = std::max<std::size_t>(frames, 48); // two seconds, the shortest that the balls take
    auto scene =
        is_rotation
            ? scenes::any_animation(scenes::camera_rotation(whole, glm::radians(5.0f) * static_cast<float>(whole)))
            : scenes::make_scene(name, whole);
    auto const share = is_rotation ? 0.6f : name == "bouncing_balls" ? 0.5f : 0.8f;
    return scenes::any_animation(first_frames(scenes::any_animation(close_up(std::move(scene), share)), frames));
}

/// A scene, rasterised at a multiple of the size of its images. None of them can be drawn as a scene of the training data:
/// those of the held-out set have shapes, motions and numbers of things that do not occur there, those of the development
/// set another seed, and motion.
struct evaluation_scene {
    std::string name;
    scene_set set;
    subject_words subject;
    std::vector<miniature::pattern_layout> layouts; ///< by an object's number; further ones are solid
    scenes::any_animation animation;
    grid_extents image;
    rendered_guidance guidance;
    tensor<float, 3> inverse_depth; ///< [frames, height, width] of the images, in [0, 1]
    pixel_correspondence pixels;    ///< what errors are measured at
    environment_rays rays;          ///< what background_noise::environment needs

    std::size_t frame_count() const { return animation.frame_count(); }
    uv_maps_view uv() const { return to_uv_view(guidance.uv); }
};

/// The names of the scenes of a set.
inline std::vector<std::string> scene_names(scene_set set) {
    return set == scene_set::development ? std::vector<std::string>(development_names.begin(), development_names.end())
                                         : std::vector<std::string>(scenes::names.begin(), scenes::names.end());
}

/// What captions call the things of a scene. Throws as development_world does.
inline subject_words subject_of(std::string const& name, scene_set set) {
    return set == scene_set::development ? development_world(name, 1).subject()
           : name == "walking_figure"    ? subject_words{"a", "figure"}
                                         : subject_words{"some", "toys"};
}

/// The scene `name` in `frames` frames of `image` pixels, its maps `map_pixels` times as fine. Throws as make_scene,
/// development_world and rasterize do.
inline evaluation_scene make_evaluation_scene(std::string const& name, scene_set set, std::size_t frames,
                                              grid_extents image, any_loop const& loop, std::size_t map_pixels = 4) {
    std::vector<miniature::pattern_layout> layouts{miniature::pattern_layout::flat};
    auto animation = [&] {
        if (set == scene_set::held_out) {
            return compared_animation(name, frames);
        }
        development_world world(name, frames);
        layouts = world.layouts();
        return scenes::any_animation(std::move(world));
    }();
    grid_extents const fine{map_pixels * image.height, map_pixels * image.width};
    auto guidance = rasterize(animation, fine, loop);
    auto inverse_depth = cell_means(sequence_inverse_depth(guidance.depth), image);
    pixel_correspondence pixels(to_uv_view(guidance.uv), image, 0.25, loop);
    auto rays = detail::rays_of(animation, fine);
    return {name,
            set,
            subject_of(name, set),
            std::move(layouts),
            std::move(animation),
            image,
            std::move(guidance),
            std::move(inverse_depth),
            std::move(pixels),
            std::move(rays)};
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

/// What a caption says on all objects of a scene: images [frames, 3, height, width]. The same seed paints the same surfaces
/// in the same way, so that only light and view change from frame to frame.
inline tensor<float, 4> painted_frames(evaluation_scene const& scene, compared_caption const& caption,
                                       std::uint64_t seed, any_loop const& loop) {
    auto const first = scene.animation.frame({0});
    random_draw draw(seed, 0);
    miniature::picture_paint paint;
    // Features as large as in the training data: 9 to 15 pixels of 128, where half of what stands out is nearer.
    auto const pixel_size = 2 * std::tan(first.camera.vertical_fov / 2) * middle_depth(scene) / 128;
    auto const feature =
        pixel_size * draw.uniform(9, 15) * (caption.pattern == miniature::surface_pattern::bricks ? 1.25f : 1.0f);
    auto const first_shade = miniature::draw_shade(draw, caption.first);
    auto const second_shade = miniature::draw_shade(draw, caption.second);
    for (auto const& posed : first.objects) {
        miniature::paint_recipe recipe{caption.pattern,
                                       miniature::surface_material::smooth,
                                       miniature::pattern_layout::solid,
                                       first_shade,
                                       second_shade,
                                       feature};
        if (posed.object.value < scene.layouts.size()) {
            recipe.layout = scene.layouts[posed.object.value];
        }
        auto const is_subject = stands_out(posed.object);
        if (!is_subject) {
            recipe.pattern = miniature::surface_pattern::plain;
            recipe.first = miniature::draw_quiet_shade(draw, caption.ground);
        }
        paint.surfaces.emplace_back(draw, recipe, *posed.surface);
        paint.is_subject.push_back(is_subject ? 1 : 0);
    }
    miniature::detail::draw_light(draw, caption.light, paint);
    auto images = tensor<float, 4>::from_shape({scene.frame_count(), 3, scene.image.height, scene.image.width});
    loop(scene.frame_count(), [&](std::size_t i) {
        auto const posed = scene.animation.frame({static_cast<std::uint32_t>(i)});
        auto const [target, reach] = middle_and_radius(posed);
        auto const picture = miniature::draw_lit(posed, paint, scene.image, 3, target, 1.6f * reach);
        copy(to_view(images)[i], to_view(picture.image));
    });
    return images;
}

} // namespace genrender::examples
