// SPDX-License-Identifier: MIT
// The six colours of the small world, the shades that each of them has, and which pairs training never shows.
#pragma once

#include "random_draw.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace genrender::examples::miniature {

/// The words for colours, in the order of world_colour.
inline constexpr std::array<std::string_view, 6> colour_words{"red", "yellow", "green", "blue", "white", "black"};

/// A colour by its number in colour_words.
enum class world_colour : std::uint8_t { red, yellow, green, blue, white, black };

/// Red, green and blue in [0, 1] of a hue in turns, a saturation and a value in [0, 1].
inline glm::vec3 colour_of(float hue, float saturation, float value) {
    auto const channel = [&](float shift) {
        auto const place = std::abs(std::fmod(hue + shift + 2, 1.0f) * 6 - 3) - 1;
        return value * (1 - saturation * (1 - std::clamp(place, 0.0f, 1.0f)));
    };
    return {channel(0), channel(2.0f / 3), channel(1.0f / 3)};
}

/// How bright a colour looks, in [0, 1] (Rec. 709's weights).
inline float luma(glm::vec3 colour) { return glm::dot(colour, glm::vec3(0.2126f, 0.7152f, 0.0722f)); }

namespace detail {

/// What the shades of a colour have in common: hues in degrees, saturations and values.
struct shade_range {
    std::array<float, 2> hue, saturation, value;
};

inline constexpr std::array<shade_range, 6> shade_ranges{{{{-5, 8}, {0.78f, 0.92f}, {0.78f, 0.95f}},
                                                          {{45, 54}, {0.8f, 0.95f}, {0.92f, 1}},
                                                          {{112, 150}, {0.6f, 0.85f}, {0.5f, 0.75f}},
                                                          {{212, 232}, {0.7f, 0.9f}, {0.65f, 0.92f}},
                                                          {{0, 360}, {0, 0.06f}, {0.93f, 1}},
                                                          {{0, 360}, {0, 0.3f}, {0.07f, 0.15f}}}};

inline glm::vec3 shade_in(random_draw& draw, shade_range const& range) {
    auto const hue = draw.uniform(range.hue[0], range.hue[1]) / 360 + 1;
    auto const saturation = draw.uniform(range.saturation[0], range.saturation[1]);
    return colour_of(hue, saturation, draw.uniform(range.value[0], range.value[1]));
}

} // namespace detail

/// A strong shade of the colour, for what a picture is about: red, green and blue in [0, 1].
inline glm::vec3 draw_shade(random_draw& draw, world_colour colour) {
    return detail::shade_in(draw, detail::shade_ranges[static_cast<std::size_t>(colour)]);
}

/// A quiet shade of the colour, for grounds and walls: red, green and blue in [0, 1].
inline glm::vec3 draw_quiet_shade(random_draw& draw, world_colour colour) {
    auto range = detail::shade_ranges[static_cast<std::size_t>(colour)];
    auto const is_grey = range.saturation[1] <= 0.3f;
    for (auto& saturation : range.saturation) {
        saturation *= is_grey ? 1.0f : 0.55f;
    }
    range.value = colour == world_colour::white   ? std::array{0.84f, 0.93f}
                  : colour == world_colour::black ? std::array{0.18f, 0.28f}
                                                  : std::array{0.5f, 0.8f};
    return detail::shade_in(draw, range);
}

/// Which paints a set of pictures may have.
enum class picture_set : std::uint8_t { training, held_out };

/// Whether training never shows the pattern of this number in these two colours, in either order: one such triple in
/// seven.
inline bool is_held_out(std::size_t pattern, world_colour first, world_colour second) {
    auto const low = static_cast<std::size_t>(std::min(first, second));
    auto const high = static_cast<std::size_t>(std::max(first, second));
    return low != high && (2 * pattern + 3 * low + high) % 7 == 0;
}

} // namespace genrender::examples::miniature
