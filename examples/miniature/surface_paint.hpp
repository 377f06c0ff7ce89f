// SPDX-License-Identifier: MIT
// What surfaces are painted with: patterns of two colours in the rest pose's own space, on a material.
#pragma once

#include "random_draw.hpp"
#include "surface_texture.hpp"

#include <genrender/scene/mesh.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

namespace genrender::examples::miniature {

/// The names of patterns, in the order of surface_pattern.
inline constexpr std::array<std::string_view, 6> pattern_names{"plain", "checker", "stripes",
                                                               "dots",  "bricks",  "waves"};

/// A pattern by its number in pattern_names. The first colour is that of the ground between dots and of bricks.
enum class surface_pattern : std::uint8_t { plain, checker, stripes, dots, bricks, waves };

/// The names of materials, in the order of surface_material.
inline constexpr std::array<std::string_view, 3> material_names{"smooth", "wood", "stone"};

/// A material by its number in material_names: how the brightness of a colour varies.
enum class surface_material : std::uint8_t { smooth, wood, stone };

/// How a pattern lies on a surface: in space, around an upright axis, on the faces of a box, on the plane y = 0.
enum class pattern_layout : std::uint8_t { solid, turned, box, flat };

/// What a paint is made of.
struct paint_recipe {
    surface_pattern pattern = surface_pattern::plain;
    surface_material material = surface_material::smooth;
    pattern_layout layout = pattern_layout::solid;
    glm::vec3 first{1};  ///< red, green and blue in [0, 1]
    glm::vec3 second{0}; ///< the other colour of the pattern; plain surfaces have the first alone
    float feature = 1;   ///< width of a stripe, side of a square, height of a brick, ... in scene units, > 0
};

/// How one object is painted. Where its pattern begins is left to chance.
class surface_paint {
public:
    /// A paint for `surface` at rest; a box has its squares and bricks fitted to its faces.
    surface_paint(random_draw& draw, paint_recipe const& recipe, mesh const& surface) : recipe_(recipe) {
        noise_ = draw.below(1U << 30U);
        auto lower = glm::vec3(std::numeric_limits<float>::max());
        auto upper = -lower;
        for (auto const& p : surface.positions) {
            lower = glm::min(lower, p);
            upper = glm::max(upper, p);
        }
        auto const size = glm::max(upper - lower, glm::vec3(1e-6f));
        cells_a_unit_ = glm::vec3(1 / recipe.feature);
        shift_ = glm::vec3(draw.uniform(0, 64), draw.uniform(0, 64), draw.uniform(0, 64));
        if (recipe.layout == pattern_layout::box) {
            // Whole cells between two faces, and faces inside of cells, so that no face is cut lengthwise by an edge.
            half_ = size / 2.0f;
            cells_a_unit_ = glm::max(glm::round(size / recipe.feature), glm::vec3(1)) / size;
            shift_ = glm::floor(shift_) + 0.2f + 0.6f * glm::fract(shift_) - lower * cells_a_unit_;
        } else if (recipe.layout == pattern_layout::turned) {
            auto const girth = std::numbers::pi_v<float> * std::max(size.x, size.z);
            around_ = std::max(2.0f, std::round(girth / recipe.feature / 2)) * 2;
        }
        if (recipe.pattern == surface_pattern::dots && recipe.layout != pattern_layout::flat) {
            dots_ = scattered_points(draw, surface, 1.55f * recipe.feature);
        }
    }

    /// The colour of the point that rests at `p`, before light: red, green and blue in [0, 1]. `contrast` in [0, 1]
    /// takes the pattern back to the mean of its colours where it is too small to be seen.
    glm::vec3 colour_at(glm::vec3 p, float contrast = 1) const {
        auto const share = recipe_.pattern == surface_pattern::plain ? 0.0f : second_share(p) ? 1.0f : 0.0f;
        auto const mean = recipe_.pattern == surface_pattern::plain    ? 0.0f
                          : recipe_.pattern == surface_pattern::bricks ? 0.4f
                                                                       : 0.5f;
        auto const colour = glm::mix(recipe_.first, recipe_.second, glm::mix(mean, share, contrast));
        return glm::clamp(colour * (1 + contrast * grain(p)), 0.0f, 1.0f);
    }

    /// Width of a feature in scene units.
    float feature() const { return recipe_.feature; }

private:
    static bool is_odd(float place) { return (static_cast<int>(std::floor(place)) & 1) != 0; }

    /// Along a row of the pattern and across the rows, in features.
    glm::vec2 along_and_across(glm::vec3 p) const {
        auto const place = p * cells_a_unit_ + shift_;
        switch (recipe_.layout) {
        case pattern_layout::flat:
            return {place.x, place.z};
        case pattern_layout::turned:
            return {std::atan2(p.x, p.z) / (2 * std::numbers::pi_v<float>)*around_ + shift_.x, place.y};
        case pattern_layout::box: {
            auto const way = glm::abs(p) / half_;
            if (way.y >= std::max(way.x, way.z)) {
                return {place.x, place.z};
            }
            return {way.x > way.z ? place.z : place.x, place.y};
        }
        case pattern_layout::solid:
            break;
        }
        return {place.x + place.z, place.y};
    }

    /// Whether the point has the second colour.
    bool second_share(glm::vec3 p) const {
        auto const place = p * cells_a_unit_ + shift_;
        switch (recipe_.pattern) {
        case surface_pattern::checker:
            if (recipe_.layout == pattern_layout::turned) {
                auto const on = along_and_across(p);
                return is_odd(on.x - shift_.x) != is_odd(on.y);
            }
            return is_odd(place.x) != (is_odd(place.z) != (recipe_.layout != pattern_layout::flat && is_odd(place.y)));
        case surface_pattern::stripes:
            return is_odd(recipe_.layout == pattern_layout::flat ? place.x : place.y);
        case surface_pattern::waves: {
            auto const on = along_and_across(p);
            auto const along = recipe_.layout == pattern_layout::turned ? on.x - shift_.x : on.x;
            auto const periods = recipe_.layout == pattern_layout::turned
                                     ? along / around_ * std::max(2.0f, std::round(around_ / 3.4f))
                                     : along / 3.4f;
            return is_odd(on.y + 0.5f * std::sin(2 * std::numbers::pi_v<float> * periods));
        }
        case surface_pattern::bricks: {
            auto const on = along_and_across(p);
            auto const row = std::floor(on.y);
            auto const along = recipe_.layout == pattern_layout::turned ? on.x - shift_.x : on.x;
            auto const brick = glm::fract(along / 2 + row / 2);
            constexpr float joint = 0.28f;
            return on.y - row < joint || brick * 2 < joint;
        }
        case surface_pattern::dots: {
            if (recipe_.layout == pattern_layout::flat) {
                auto const row = std::floor(place.z / 1.4f);
                auto const cell = glm::vec2(glm::fract(place.x / 1.6f + row / 2), glm::fract(place.z / 1.4f)) - 0.5f;
                return glm::length(cell * glm::vec2(1.6f, 1.4f)) < 0.5f;
            }
            auto nearest = std::numeric_limits<float>::max();
            for (auto const& dot : dots_) {
                auto const way = dot - p;
                nearest = std::min(nearest, glm::dot(way, way));
            }
            return nearest < 0.3f * recipe_.feature * recipe_.feature;
        }
        case surface_pattern::plain:
            break;
        }
        return false;
    }

    /// By how much of itself the material changes a colour.
    float grain(glm::vec3 p) const {
        auto const place = p / recipe_.feature;
        switch (recipe_.material) {
        case surface_material::wood:
            return 0.35f * gradient_noise(noise_, place * glm::vec3(0.45f, 1.7f, 1.7f));
        case surface_material::stone:
            return 0.32f * gradient_noise(noise_, place * 0.9f) + 0.2f * gradient_noise(noise_ + 1, place * 1.9f);
        case surface_material::smooth:
            break;
        }
        return 0;
    }

    paint_recipe recipe_;
    glm::vec3 cells_a_unit_{1};
    glm::vec3 shift_{0};
    glm::vec3 half_{1};
    float around_ = 2; ///< features around a turned surface, a whole even number
    std::uint32_t noise_ = 0;
    std::vector<glm::vec3> dots_;
};

} // namespace genrender::examples::miniature
