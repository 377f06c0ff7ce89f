// SPDX-License-Identifier: MIT
// The shapes of the small world: balls, eggs, vases, boxes, pillars and figures of about unit size around the origin.
#pragma once

#include "random_draw.hpp"
#include "surface_paint.hpp"

#include <genrender/scene/animation.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/scene/primitives.hpp>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::examples::miniature {

/// The words for shapes, in the order of world_shape.
inline constexpr std::array<std::string_view, 6> shape_words{"ball", "egg", "vase", "box", "pillar", "figure"};

/// A shape by its number in shape_words.
enum class world_shape : std::uint8_t { ball, egg, vase, box, pillar, figure };

namespace detail {

/// A closed surface of revolution with a wavy profile.
inline mesh draw_vase(random_draw& draw, float radius) {
    constexpr int points = 18;
    auto const half_height = radius * draw.uniform(0.9f, 1.7f);
    auto const narrow = draw.uniform(0.2f, 0.5f);
    auto const waves = draw.uniform(0.7f, 1.6f);
    auto const phase = draw.uniform(0, 2 * std::numbers::pi_v<float>);
    std::vector<glm::vec2> profile{{0, half_height}};
    for (int i = 0; i < points; ++i) {
        auto const t = (static_cast<float>(i) + 0.5f) / points;
        auto const cap = std::pow(std::sin(std::numbers::pi_v<float> * t), 0.35f);
        auto const wave = 1 - narrow * (0.5f + 0.5f * std::sin(2 * std::numbers::pi_v<float> * waves * t + phase));
        profile.push_back({std::max(radius * cap * wave, 0.02f * radius), half_height * (1 - 2 * t)});
    }
    profile.push_back({0, -half_height});
    return revolve(profile, 32);
}

inline mesh draw_egg(random_draw& draw, float radius) {
    auto egg = make_sphere(radius, 32);
    auto const tall = draw.chance(0.6f) ? draw.uniform(1.2f, 1.6f) : draw.uniform(0.6f, 0.8f);
    for (auto& p : egg.positions) {
        p *= glm::vec3(1, tall, 1);
    }
    egg.normals.clear();
    return egg;
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

/// A figure of a trunk, a head, two arms and two legs of two bones each, in any pose that stands or leaps.
inline mesh draw_figure(random_draw& draw, float size) {
    mesh whole;
    auto const trunk = size * draw.uniform(0.8f, 1.05f);
    auto const thick = size * draw.uniform(0.26f, 0.38f);
    auto const lean = glm::vec3(draw.uniform(-0.2f, 0.2f), 1, draw.uniform(-0.2f, 0.2f)) * trunk;
    append_limb(whole, {0, 0, 0}, lean, thick);
    append_limb(whole, lean * 1.5f, lean * 1.62f, thick * draw.uniform(0.7f, 0.95f));
    auto const legs = size * draw.uniform(0.15f, 0.2f);
    for (auto const side : {-1.0f, 1.0f}) {
        auto const hip = glm::vec3(side * thick * 0.55f, -0.1f * size, 0);
        auto const knee =
            hip + glm::normalize(glm::vec3(side * draw.uniform(0, 0.35f), -1, draw.uniform(-0.7f, 0.7f))) * size *
                      draw.uniform(0.6f, 0.8f);
        auto const foot =
            knee + glm::normalize(glm::vec3(side * draw.uniform(-0.1f, 0.25f), -1, draw.uniform(-0.8f, 0.3f))) * size *
                       draw.uniform(0.55f, 0.8f);
        append_limb(whole, hip, knee, legs);
        append_limb(whole, knee, foot, legs * 0.85f);
        auto const shoulder = lean * 0.95f + glm::vec3(side * thick * 1.05f, 0, 0);
        auto const elbow = shoulder + glm::normalize(glm::vec3(side * draw.uniform(0.1f, 1.2f), draw.uniform(-1, 0.6f),
                                                               draw.uniform(-0.8f, 0.8f))) *
                                          size * draw.uniform(0.45f, 0.6f);
        auto const hand = elbow + glm::normalize(glm::vec3(side * draw.uniform(-0.4f, 0.8f), draw.uniform(-1, 1),
                                                           draw.uniform(-0.3f, 1))) *
                                      size * draw.uniform(0.4f, 0.55f);
        append_limb(whole, shoulder, elbow, legs * 0.8f);
        append_limb(whole, elbow, hand, legs * 0.7f);
    }
    return whole;
}

} // namespace detail

/// A surface of the shape, its size about twice `radius` > 0, scene units.
inline mesh draw_shape(random_draw& draw, world_shape shape, float radius) {
    switch (shape) {
    case world_shape::egg:
        return detail::draw_egg(draw, radius * 0.9f);
    case world_shape::vase:
        return detail::draw_vase(draw, radius);
    case world_shape::box:
        return make_box(glm::vec3(draw.uniform(1.0f, 1.9f), draw.uniform(0.9f, 2.2f), draw.uniform(1.0f, 1.9f)) *
                        radius);
    case world_shape::pillar:
        return make_cylinder(radius * draw.uniform(0.45f, 0.75f), radius * draw.uniform(1.4f, 2.8f), 32);
    case world_shape::figure:
        return detail::draw_figure(draw, radius);
    case world_shape::ball:
        break;
    }
    return make_sphere(radius, 36);
}

/// How patterns lie on the shape.
inline pattern_layout layout_of(world_shape shape) {
    return shape == world_shape::box      ? pattern_layout::box
           : shape == world_shape::figure ? pattern_layout::solid
                                          : pattern_layout::turned;
}

} // namespace genrender::examples::miniature
