// SPDX-License-Identifier: MIT
// Invented still scenes to learn from: turned, boxed, egg-shaped and jointed things on a ground under a sky.
#pragma once

#include "lit_render.hpp"
#include "palette.hpp"
#include "../miniature/random_draw.hpp"
#include "surface_style.hpp"

#include <genrender/core/index.hpp>
#include <genrender/scene/animation.hpp>
#include <genrender/scene/camera.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/scene/primitives.hpp>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace genrender::examples {

/// One example to learn from, before it is drawn.
struct training_scene {
    posed_scene scene;
    scene_paint paint;
    glm::vec3 target;    ///< the middle of the objects
    float shadow_radius; ///< around it
    surface_style style;
    std::optional<std::size_t> colour; ///< a number in colour_words, if the prompt names one
};

namespace detail {

/// A closed surface of revolution about as wide as `radius` and as high as twice that, with a wavy profile.
inline mesh draw_turned(random_draw& draw, float radius) {
    constexpr int points = 18;
    auto const half_height = radius * draw.uniform(0.7f, 1.8f);
    auto const narrow = draw.uniform(0.0f, 0.45f);
    auto const waves = draw.uniform(0.5f, 1.8f);
    auto const phase = draw.uniform(0, 2 * std::numbers::pi_v<float>);
    std::vector<glm::vec2> profile{{0, half_height}};
    for (int i = 0; i < points; ++i) {
        auto const t = (static_cast<float>(i) + 0.5f) / points;
        auto const cap = std::pow(std::sin(std::numbers::pi_v<float> * t), 0.35f);
        auto const wave = 1 - narrow * (0.5f + 0.5f * std::sin(2 * std::numbers::pi_v<float> * waves * t + phase));
        profile.push_back({std::max(radius * cap * wave, 0.02f * radius), half_height * (1 - 2 * t)});
    }
    profile.push_back({0, -half_height});
    return revolve(profile, 28);
}

inline mesh stretched(mesh surface, glm::vec3 factor) {
    for (auto& p : surface.positions) {
        p *= factor;
    }
    surface.normals.clear();
    return surface;
}

/// An egg or a disc, never a ball: its axes differ by a fifth or more.
inline mesh draw_egg(random_draw& draw, float radius) {
    auto const tall = draw.chance(0.5f) ? draw.uniform(1.2f, 1.8f) : draw.uniform(0.5f, 0.8f);
    return stretched(make_sphere(radius, 28), {1, tall, draw.uniform(0.85f, 1.15f)});
}

inline mesh draw_box(random_draw& draw, float radius) {
    return make_box(glm::vec3(draw.uniform(1.0f, 1.9f), draw.uniform(0.9f, 2.4f), draw.uniform(1.0f, 1.9f)) * radius);
}

/// A limb between two points.
inline void append_limb(mesh& whole, glm::vec3 from, glm::vec3 to, float radius) {
    auto const way = to - from;
    auto const length = std::max(glm::length(way), 1e-3f);
    auto part = make_capsule(radius, length, 16);
    auto const up = way / length;
    auto const side = glm::normalize(glm::cross(std::abs(up.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1), up));
    glm::mat4 frame(1);
    frame[0] = glm::vec4(side, 0);
    frame[1] = glm::vec4(up, 0);
    frame[2] = glm::vec4(glm::cross(side, up), 0);
    frame[3] = glm::vec4((from + to) * 0.5f, 1);
    part.positions = transformed(std::move(part.positions), frame);
    part.normals.clear();
    append(whole, part);
}

/// A creature of a trunk, a head and limbs of two bones in any pose.
inline mesh draw_creature(random_draw& draw, float size) {
    mesh whole;
    auto const trunk = size * draw.uniform(0.75f, 1.1f);
    auto const thick = size * draw.uniform(0.26f, 0.42f);
    auto const lean = glm::vec3(draw.uniform(-0.25f, 0.25f), 1, draw.uniform(-0.25f, 0.25f)) * trunk;
    append_limb(whole, {0, 0, 0}, lean, thick);
    append_limb(whole, lean * 1.45f, lean * 1.62f, thick * draw.uniform(0.6f, 0.95f));
    auto const limbs = 2 + draw.below(3);
    for (std::uint32_t i = 0; i < limbs; ++i) {
        auto const low = i % 2 == 0;
        auto const root = low ? glm::vec3(0) : lean * 0.95f;
        auto direction = draw.direction();
        direction.y = low ? -std::abs(direction.y) - 0.6f : direction.y * 0.7f;
        auto const joint = root + glm::normalize(direction) * size * draw.uniform(0.6f, 0.95f);
        auto const bend = glm::normalize(direction + 0.8f * draw.direction());
        auto const thickness = size * draw.uniform(0.14f, 0.24f);
        append_limb(whole, root, joint, thickness);
        append_limb(whole, joint, joint + bend * size * draw.uniform(0.5f, 0.85f), thickness * 0.85f);
    }
    return whole;
}

inline float lowest_of(std::vector<glm::vec3> const& positions) {
    auto lowest = positions.front().y;
    for (auto const& p : positions) {
        lowest = std::min(lowest, p.y);
    }
    return lowest;
}

} // namespace detail

/// The scene of a number, the same for the same seed.
inline training_scene draw_training_scene(std::uint64_t seed, std::uint32_t number) {
    random_draw draw(seed, number);
    training_scene drawn;
    drawn.style = static_cast<surface_style>(draw.below(std::uint32_t{style_words.size()}));
    if (draw.chance(0.5f)) {
        drawn.colour = draw.below(std::uint32_t{colour_words.size()});
    }

    // Shapes of about unit size around the origin, few enough to fill the picture.
    constexpr std::array<std::uint32_t, 8> counts{1, 1, 1, 2, 2, 2, 3, 4};
    auto const count = counts[draw.below(8)];
    auto const spread = count == 1 ? 0.0f : 0.75f * std::sqrt(static_cast<float>(count));
    std::vector<posed_object> things;
    for (std::uint32_t i = 0; i < count; ++i) {
        auto const radius = draw.uniform(0.55f, 1.0f);
        auto const kind = draw.below(7);
        auto surface = kind < 2   ? detail::draw_turned(draw, radius)
                       : kind < 4 ? detail::draw_egg(draw, radius)
                       : kind < 6 ? detail::draw_box(draw, radius)
                                  : detail::draw_creature(draw, radius);
        auto const shared = std::make_shared<mesh const>(std::move(surface));
        auto turn = glm::rotate(glm::mat4(1), draw.uniform(0, 6.2832f), glm::vec3(0, 1, 0));
        if (draw.chance(0.35f)) {
            turn = glm::rotate(turn, draw.uniform(0.2f, 1.5f), draw.direction());
        }
        auto const angle = 6.2832f * (static_cast<float>(i) + draw.uniform(0, 0.6f)) / static_cast<float>(count);
        auto at = glm::vec3(std::cos(angle), 0, std::sin(angle)) * spread * draw.uniform(0.75f, 1.25f);
        at.y = -detail::lowest_of(transformed(shared->positions, turn));
        if (draw.chance(0.2f)) {
            at.y += draw.uniform(0.1f, 1.4f); // in the air
        }
        things.push_back(pose({i + 1}, shared, glm::translate(glm::mat4(1), at) * turn));
    }

    // An eye that sees the things large; sometimes a part of them alone.
    auto lower = glm::vec3(1e9f);
    auto upper = -lower;
    for (auto const& thing : things) {
        for (auto const& p : thing.positions) {
            lower = glm::min(lower, p);
            upper = glm::max(upper, p);
        }
    }
    drawn.target = (lower + upper) * 0.5f;
    auto const radius = glm::length(upper - lower) * 0.5f;
    drawn.shadow_radius = radius * 1.6f;
    auto const fov = glm::radians(draw.uniform(30, 50));
    auto const distance = radius / std::tan(fov / 2) * draw.uniform(0.5f, 0.85f);
    auto const azimuth = draw.uniform(0, 6.2832f);
    auto const elevation = glm::radians(draw.uniform(4, 38));
    auto const away = glm::vec3(std::cos(azimuth) * std::cos(elevation), std::sin(elevation),
                                std::sin(azimuth) * std::cos(elevation));
    auto const aim = drawn.target + draw.direction() * radius * draw.uniform(0, 0.25f);
    auto eye = aim + away * std::max(distance, 1.2f);
    eye.y = std::max(eye.y, 0.25f);
    drawn.scene.camera = look_at(eye, aim, fov);

    // What the surfaces are painted with; a feature is 7 to 10 pixels of 64 at the middle of the scene.
    auto const with_ground = draw.chance(0.9f);
    auto const pixel_size = 2 * std::tan(fov / 2) * glm::distance(eye, drawn.target) / 64;
    auto const feature = pixel_size * draw.uniform(7, 10);
    auto const shared_colours = draw_palette(draw, drawn.colour, palette_set::training);
    auto const is_shared = draw.chance(0.5f);
    if (with_ground) {
        auto const ground = std::make_shared<mesh const>(make_plane({160, 160}, 4));
        drawn.scene.objects.push_back(pose({0}, ground, glm::mat4(1)));
        drawn.paint.surfaces.emplace_back(draw, surface_style::plain, draw_ground(draw), *ground, 1.0f);
        drawn.paint.is_patterned.push_back(0);
    }
    for (auto& thing : things) {
        auto const colours = is_shared ? shared_colours : draw_palette(draw, drawn.colour, palette_set::training);
        drawn.paint.surfaces.emplace_back(draw, drawn.style, colours, *thing.surface, feature);
        drawn.paint.is_patterned.push_back(1);
        drawn.scene.objects.push_back(std::move(thing));
    }
    draw_sky(draw, drawn.paint);
    return drawn;
}

} // namespace genrender::examples
