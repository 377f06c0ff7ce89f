// SPDX-License-Identifier: MIT
// Invented still scenes of the small world: what stands where, what it is painted with, and the light over it.
#pragma once

#include "lit_picture.hpp"
#include "random_draw.hpp"
#include "surface_paint.hpp"
#include "world_colours.hpp"
#include "world_shapes.hpp"

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
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::examples::miniature {

/// The names of lights, in the order of world_light.
inline constexpr std::array<std::string_view, 7> light_names{"clear day", "clouds", "sunset",    "night",
                                                             "mist",      "room",   "lamp light"};

/// A light by its number in light_names; the last two are those of rooms.
enum class world_light : std::uint8_t { clear_day, clouds, sunset, night, mist, room, lamp };

/// What a wall or a ground is painted with: a pattern in shades of one colour.
struct backdrop {
    surface_pattern pattern = surface_pattern::plain;
    surface_material material = surface_material::smooth;
    world_colour colour = world_colour::white;
};

/// What can be said of a picture.
struct world_description {
    std::vector<world_shape> shapes; ///< one a thing; all are painted alike
    surface_pattern pattern = surface_pattern::plain;
    surface_material material = surface_material::smooth;
    world_colour first = world_colour::red;    ///< of the things
    world_colour second = world_colour::white; ///< of their pattern; says nothing where the pattern is plain
    world_light light = world_light::clear_day;
    bool has_ground = true;
    backdrop ground;
    backdrop wall; ///< where the light is that of a room

    /// Whether walls stand around.
    bool is_room() const { return light == world_light::room || light == world_light::lamp; }
};

/// One example to learn from, before it is drawn.
struct world_scene {
    world_description description;
    posed_scene scene;
    picture_paint paint;
    glm::vec3 target{0};     ///< the middle of the things
    float shadow_radius = 1; ///< around it
};

namespace detail {

inline backdrop draw_backdrop(random_draw& draw) {
    constexpr std::array colours{world_colour::green, world_colour::green, world_colour::green,  world_colour::yellow,
                                 world_colour::red,   world_colour::blue,  world_colour::yellow, world_colour::white,
                                 world_colour::white, world_colour::black};
    backdrop drawn;
    drawn.pattern = draw.chance(0.4f) ? surface_pattern::plain
                                      : static_cast<surface_pattern>(draw.below(std::uint32_t{pattern_names.size()}));
    drawn.material = static_cast<surface_material>(draw.below(std::uint32_t{material_names.size()}));
    drawn.colour = colours[draw.below(std::uint32_t{colours.size()})];
    return drawn;
}

inline world_description draw_description(random_draw& draw, picture_set set) {
    world_description drawn;
    do {
        drawn.pattern = draw.chance(0.1f) ? surface_pattern::plain : static_cast<surface_pattern>(1 + draw.below(5));
        drawn.first = static_cast<world_colour>(draw.below(std::uint32_t{colour_words.size()}));
        drawn.second = static_cast<world_colour>(draw.below(std::uint32_t{colour_words.size()}));
    } while (drawn.pattern != surface_pattern::plain &&
             (drawn.first == drawn.second || is_held_out(static_cast<std::size_t>(drawn.pattern), drawn.first,
                                                         drawn.second) != (set == picture_set::held_out)));
    drawn.material = draw.chance(0.5f) ? surface_material::smooth : static_cast<surface_material>(1 + draw.below(2));
    constexpr std::array<std::uint32_t, 8> counts{1, 1, 1, 1, 2, 2, 3, 4};
    auto const count = counts[draw.below(8)];
    auto const is_mixed = draw.chance(0.5f);
    for (std::uint32_t i = 0; i < count; ++i) {
        drawn.shapes.push_back(i > 0 && !is_mixed
                                   ? drawn.shapes.front()
                                   : static_cast<world_shape>(draw.below(std::uint32_t{shape_words.size()})));
    }
    constexpr std::array lights{
        world_light::clear_day, world_light::clear_day, world_light::clouds, world_light::clouds, world_light::sunset,
        world_light::night,     world_light::mist,      world_light::room,   world_light::room,   world_light::lamp};
    drawn.light = lights[draw.below(std::uint32_t{lights.size()})];
    drawn.has_ground = drawn.is_room() || draw.chance(0.93f);
    drawn.ground = draw_backdrop(draw);
    drawn.wall = draw_backdrop(draw);
    return drawn;
}

/// Colours of the sky and of the light.
inline void draw_light(random_draw& draw, world_light light, picture_paint& paint) {
    paint.cloud_seed = draw.below(1U << 30U);
    auto const blue = draw.uniform(0.56f, 0.62f);
    switch (light) {
    case world_light::clouds:
        paint.clouds = draw.uniform(0.8f, 1);
        [[fallthrough]];
    case world_light::clear_day:
        paint.horizon = colour_of(blue - 0.02f, draw.uniform(0.08f, 0.2f), draw.uniform(0.93f, 1));
        paint.zenith = colour_of(blue, draw.uniform(0.5f, 0.7f), draw.uniform(0.8f, 0.95f));
        break;
    case world_light::sunset:
        paint.horizon = colour_of(draw.uniform(0.05f, 0.1f), draw.uniform(0.45f, 0.65f), 1);
        paint.zenith = colour_of(draw.uniform(0.86f, 0.95f), draw.uniform(0.3f, 0.45f), draw.uniform(0.6f, 0.8f));
        paint.tint = {1.06f, 0.9f, 0.74f};
        break;
    case world_light::night:
        paint.horizon = colour_of(0.64f, 0.6f, draw.uniform(0.25f, 0.38f));
        paint.zenith = colour_of(0.66f, 0.75f, draw.uniform(0.08f, 0.16f));
        paint.tint = {0.55f, 0.63f, 0.88f};
        break;
    case world_light::mist:
        paint.horizon = glm::vec3(draw.uniform(0.82f, 0.92f));
        paint.zenith = paint.horizon * glm::vec3(0.93f, 0.96f, 1);
        paint.tint = glm::vec3(0.96f);
        paint.clear_distance = 9;
        break;
    case world_light::lamp:
        paint.horizon = paint.zenith = {0.3f, 0.24f, 0.16f};
        paint.tint = {1.04f, 0.9f, 0.66f};
        paint.clear_distance = 1e6f;
        break;
    case world_light::room:
        paint.horizon = paint.zenith = glm::vec3(0.92f);
        paint.clear_distance = 1e6f;
        break;
    }
}

inline surface_paint draw_backdrop_paint(random_draw& draw, backdrop const& of, mesh const& surface, float feature) {
    paint_recipe recipe{of.pattern, of.material, pattern_layout::flat, draw_quiet_shade(draw, of.colour), {}, feature};
    auto const step = draw.uniform(0.13f, 0.22f);
    recipe.second = luma(recipe.first) > 0.55f ? recipe.first * (1 - step) : glm::mix(recipe.first, glm::vec3(1), step);
    return surface_paint(draw, recipe, surface);
}

/// A rectangle that stands `away` from the origin in the direction `angle` and faces it.
inline posed_object wall(object_index number, glm::vec3 foot, float angle, float away, float width, float height) {
    auto to_world = glm::translate(glm::mat4(1), foot);
    to_world = glm::rotate(to_world, angle, glm::vec3(0, 1, 0));
    to_world = glm::translate(to_world, {0, height / 2, -away});
    to_world = glm::rotate(to_world, glm::radians(90.0f), glm::vec3(1, 0, 0));
    return pose(number, std::make_shared<mesh const>(make_plane({width, height}, 3)), to_world);
}

} // namespace detail

/// The scene of a number, the same for the same seed and set.
inline world_scene draw_world(std::uint64_t seed, std::uint32_t number, picture_set set = picture_set::training) {
    random_draw draw(seed, number);
    world_scene drawn;
    drawn.description = detail::draw_description(draw, set);
    auto const& description = drawn.description;

    auto const count = description.shapes.size();
    auto const spread = count == 1 ? 0.0f : 0.8f * std::sqrt(static_cast<float>(count));
    std::vector<posed_object> things;
    for (std::size_t i = 0; i < count; ++i) {
        auto const shape = description.shapes[i];
        auto const shared = std::make_shared<mesh const>(draw_shape(draw, shape, draw.uniform(0.6f, 1.0f)));
        auto turn = glm::rotate(glm::mat4(1), draw.uniform(0, 6.2832f), glm::vec3(0, 1, 0));
        if (draw.chance(shape == world_shape::figure || shape == world_shape::pillar ? 0.12f : 0.3f)) {
            turn = glm::rotate(turn, draw.uniform(0.2f, 1.5f), draw.direction());
        }
        auto const angle = 6.2832f * (static_cast<float>(i) + draw.uniform(0, 0.6f)) / static_cast<float>(count);
        auto at = glm::vec3(std::cos(angle), 0, std::sin(angle)) * spread * draw.uniform(0.8f, 1.25f);
        auto lowest = 1e9f;
        for (auto const& p : transformed(shared->positions, turn)) {
            lowest = std::min(lowest, p.y);
        }
        at.y = -lowest;
        if (draw.chance(0.18f)) {
            at.y += draw.uniform(0.1f, 1.2f); // in the air
        }
        things.push_back(pose({static_cast<std::uint32_t>(i + 1)}, shared, glm::translate(glm::mat4(1), at) * turn));
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
    auto const distance = std::max(1.2f, radius / std::tan(fov / 2) * draw.uniform(0.6f, 1.05f));
    auto const azimuth = draw.uniform(0, 6.2832f);
    auto const elevation = glm::radians(draw.uniform(5, 36));
    auto const away = glm::vec3(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                std::cos(azimuth) * std::cos(elevation));
    auto const aim = drawn.target + draw.direction() * radius * draw.uniform(0, 0.2f);
    auto eye = aim + away * distance;
    eye.y = std::max(eye.y, 0.3f);
    drawn.scene.camera = look_at(eye, aim, fov);
    auto const pixel = 2 * std::tan(fov / 2) * glm::distance(eye, drawn.target) / 128; // in the middle of the scene

    auto const add = [&](posed_object thing, surface_paint paint, bool is_subject) {
        drawn.scene.objects.push_back(std::move(thing));
        drawn.paint.surfaces.push_back(std::move(paint));
        drawn.paint.is_subject.push_back(is_subject ? 1 : 0);
    };
    if (description.has_ground) {
        auto const ground = std::make_shared<mesh const>(make_plane({160, 160}, 4));
        auto const turn = glm::rotate(glm::mat4(1), draw.uniform(0, 6.2832f), glm::vec3(0, 1, 0));
        auto paint = detail::draw_backdrop_paint(draw, description.ground, *ground, pixel * draw.uniform(15, 28));
        add(pose({0}, ground, turn), std::move(paint), false);
    }
    if (description.is_room()) {
        // Three or four walls around a rectangle that holds the things and the eye.
        auto const foot = glm::vec3(drawn.target.x, 0, drawn.target.z);
        auto const turned = azimuth + draw.uniform(-0.7f, 0.7f);
        auto const behind = radius * draw.uniform(1.15f, 1.9f);
        auto const beside = std::max(radius * draw.uniform(1.3f, 2.4f), 0.8f * distance);
        auto const height = eye.y + distance + behind;
        auto const feature = pixel * draw.uniform(11, 20);
        for (int side = 0; side < 3; ++side) {
            auto const angle = turned + glm::radians(90.0f) * static_cast<float>(side - 1);
            auto const number_of_wall = static_cast<std::uint32_t>(count + 1) + static_cast<std::uint32_t>(side);
            auto thing = detail::wall({number_of_wall}, foot, angle, side == 1 ? behind : beside,
                                      side == 1 ? 2 * beside : 2 * (behind + 2 * distance), height);
            auto paint = detail::draw_backdrop_paint(draw, description.wall, *thing.surface, feature);
            add(std::move(thing), std::move(paint), false);
        }
    }
    auto const feature = pixel * draw.uniform(9, 15);
    auto const first = draw_shade(draw, description.first);
    auto const second = draw_shade(draw, description.second);
    for (std::size_t i = 0; i < count; ++i) {
        paint_recipe const recipe{description.pattern,
                                  description.material,
                                  layout_of(description.shapes[i]),
                                  first,
                                  second,
                                  description.pattern == surface_pattern::bricks ? 1.25f * feature : feature};
        surface_paint paint(draw, recipe, *things[i].surface);
        add(std::move(things[i]), std::move(paint), true);
    }
    detail::draw_light(draw, description.light, drawn.paint);
    return drawn;
}

} // namespace genrender::examples::miniature
