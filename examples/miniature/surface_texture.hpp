// SPDX-License-Identifier: MIT
// What painted surfaces are made of: smooth noise, and points scattered over a mesh.
#pragma once

#include "random_draw.hpp"

#include <genrender/core/random.hpp>
#include <genrender/scene/mesh.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace genrender::examples {

/// Smooth noise at a point: about N(0, 0.3^2), features of about unit size (gradient noise after Perlin, 1985).
inline float gradient_noise(std::uint32_t seed, glm::vec3 p) {
    auto const cell = glm::floor(p);
    auto const inside = p - cell;
    auto const weight = inside * inside * inside * (inside * (inside * 6.0f - 15.0f) + 10.0f);
    float sum = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        auto const step = glm::vec3(corner & 1U, corner >> 1U & 1U, corner >> 2U);
        auto const at = glm::ivec3(cell + step);
        auto const bits = philox(
            {static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y), static_cast<std::uint32_t>(at.z), 0},
            {seed, 0});
        auto const gradient = glm::vec3(bits[0], bits[1], bits[2]) * 0x1p-31f - 1.0f;
        auto const side = glm::mix(1.0f - weight, weight, step);
        sum += side.x * side.y * side.z * glm::dot(gradient, inside - step);
    }
    return sum;
}

/// Points on the surface at least `spacing` apart, as many as fit in a fixed number of draws.
inline std::vector<glm::vec3> scattered_points(random_draw& draw, mesh const& surface, float spacing) {
    std::vector<float> area_until;
    float area = 0;
    for (auto const& t : surface.triangles) {
        auto const a = surface.positions[t.x];
        area += glm::length(glm::cross(surface.positions[t.y] - a, surface.positions[t.z] - a)) / 2;
        area_until.push_back(area);
    }
    std::vector<glm::vec3> points;
    auto const tries = std::min(4000, static_cast<int>(30 * area / (spacing * spacing)) + 30);
    for (int i = 0; i < tries; ++i) {
        auto const place = std::upper_bound(area_until.begin(), area_until.end(), draw.uniform(0, area));
        auto const number =
            std::min<std::size_t>(static_cast<std::size_t>(place - area_until.begin()), surface.triangles.size() - 1);
        auto const& t = surface.triangles[number];
        auto u = draw.uniform(0, 1);
        auto v = draw.uniform(0, 1);
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        auto const p = surface.positions[t.x] * (1 - u - v) + surface.positions[t.y] * u + surface.positions[t.z] * v;
        if (std::none_of(points.begin(), points.end(), [&](auto const& q) { return glm::distance(p, q) < spacing; })) {
            points.push_back(p);
        }
    }
    return points;
}

} // namespace genrender::examples
