// SPDX-License-Identifier: MIT
// The colours that surfaces are painted with, the words for them, and which pairs training never shows.
#pragma once

#include "../miniature/random_draw.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>

namespace genrender::examples {

/// The words for colours, in the order of the training data's numbers.
inline constexpr std::array<std::string_view, 6> colour_words{"red", "yellow", "green", "blue", "purple", "white"};

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

/// What one surface is painted with: the first colour is the one that a prompt names.
struct palette {
    glm::vec3 first;
    glm::vec3 second;
    glm::vec3 third; ///< between the two, for styles of three tones
};

/// Which pairs of hues a palette may have.
enum class palette_set { training, held_out };

namespace detail {

struct hue_and_colour {
    float hue;
    glm::vec3 colour;
};

inline hue_and_colour draw_first(random_draw& draw, std::optional<std::size_t> word) {
    if (!word) {
        auto const hue = draw.uniform(0, 1);
        return {hue, colour_of(hue, draw.uniform(0.45f, 0.9f), draw.uniform(0.55f, 0.95f))};
    }
    if (colour_words[*word] == "white") {
        auto const hue = draw.uniform(0, 1);
        return {hue, colour_of(hue, draw.uniform(0, 0.08f), draw.uniform(0.92f, 1))};
    }
    constexpr std::array<float, 5> degrees{0, 52, 120, 218, 285};
    auto const hue = (degrees[*word] + draw.uniform(-10, 10) + 360) / 360;
    return {hue, colour_of(hue, draw.uniform(0.7f, 0.92f), draw.uniform(0.7f, 0.95f))};
}

inline hue_and_colour draw_second(random_draw& draw) {
    auto const hue = draw.uniform(0, 1);
    switch (draw.below(3)) {
    case 0:
        return {hue, colour_of(hue, draw.uniform(0.3f, 0.8f), draw.uniform(0.08f, 0.28f))};
    case 1:
        return {hue, colour_of(hue, draw.uniform(0.02f, 0.2f), draw.uniform(0.88f, 1))};
    default:
        return {hue, colour_of(hue, draw.uniform(0.5f, 0.9f), draw.uniform(0.5f, 0.95f))};
    }
}

/// One pair of twelfths of the colour circle in seven is kept from training.
inline bool is_held_out(float first_hue, float second_hue) {
    auto const part = [](float hue) { return static_cast<int>(std::fmod(hue + 1, 1.0f) * 12); };
    return (3 * part(first_hue) + part(second_hue)) % 7 == 0;
}

} // namespace detail

/// A palette of the set, its two main colours at least 0.3 of luma apart; the first colour is that of `word`, a number
/// in colour_words, if there is one.
inline palette draw_palette(random_draw& draw, std::optional<std::size_t> word, palette_set set) {
    for (;;) {
        auto const first = detail::draw_first(draw, word);
        auto const second = detail::draw_second(draw);
        auto const in_set = detail::is_held_out(first.hue, second.hue) == (set == palette_set::held_out);
        if (in_set && std::abs(luma(first.colour) - luma(second.colour)) >= 0.3f) {
            return {first.colour, second.colour, glm::mix(first.colour, second.colour, 0.5f)};
        }
    }
}

} // namespace genrender::examples
