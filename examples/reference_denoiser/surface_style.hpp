// SPDX-License-Identifier: MIT
// The styles that prompts name: procedural textures in the rest pose's own space, coarse enough for small images.
#pragma once

#include "palette.hpp"
#include "../miniature/random_draw.hpp"
#include "../miniature/surface_texture.hpp"

#include <genrender/core/error.hpp>
#include <genrender/scene/mesh.hpp>

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
