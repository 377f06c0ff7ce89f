// SPDX-License-Identifier: MIT
// The styles that prompts name: procedural textures in the rest pose's own space, coarse enough for small images.
#pragma once

#include "palette.hpp"
#include "random_draw.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/random.hpp>
#include <genrender/scene/mesh.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// The words for styles, in the order of the training data's numbers.
inline constexpr std::array<std::string_view, 5> style_words{"plain", "stripes", "checker", "dots", "camo"};

/// A style by its number in style_words.
enum class surface_style : std::uint8_t { plain, stripes, checker, dots, camo };

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

/// How one object is painted: a style in a place, size and palette of its own.
class painted_surface {
public:
    /// `feature` is the width of a stripe, side of a square, ... in scene units.
    painted_surface(random_draw& draw, surface_style style, palette const& colours, mesh const& surface, float feature)
        : style_(style), colours_(colours), feature_(feature) {
        // Stripes go around the rest pose and squares lie along its axes, so that only their places are left to chance.
        shift_ = glm::vec3(draw.uniform(0, 64), draw.uniform(0, 64), draw.uniform(0, 64));
        noise_ = draw.below(1U << 30U);
        if (style == surface_style::dots) {
            dots_ = scattered_points(draw, surface, 1.5f * feature);
        }
    }

    /// The colour of the point that rests at `p`, before light: red, green and blue in [0, 1].
    glm::vec3 colour_at(glm::vec3 p) const {
        auto const scaled = p / feature_;
        switch (style_) {
        case surface_style::stripes: {
            return is_odd(scaled.y + shift_.y) ? colours_.first : colours_.second;
        }
        case surface_style::checker: {
            auto const place = scaled + shift_;
            return is_odd(place.x) != (is_odd(place.y) != is_odd(place.z)) ? colours_.first : colours_.second;
        }
        case surface_style::dots: {
            auto nearest = std::numeric_limits<float>::max();
            for (auto const& dot : dots_) {
                auto const way = dot - p;
                nearest = std::min(nearest, glm::dot(way, way));
            }
            return nearest < 0.27f * feature_ * feature_ ? colours_.second : colours_.first;
        }
        case surface_style::camo: {
            auto const place = scaled * 0.62f + shift_;
            auto const height = gradient_noise(noise_, place) + 0.35f * gradient_noise(noise_ + 1, place * 2.1f);
            return height > 0.11f ? colours_.second : height < -0.13f ? colours_.third : colours_.first;
        }
        case surface_style::plain:
            break;
        }
        return colours_.first;
    }

private:
    static bool is_odd(float place) { return (static_cast<int>(std::floor(place)) & 1) != 0; }

    surface_style style_;
    palette colours_;
    float feature_;
    glm::vec3 shift_{0};
    std::uint32_t noise_ = 0;
    std::vector<glm::vec3> dots_;
};

} // namespace genrender::examples
