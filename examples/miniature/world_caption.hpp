// SPDX-License-Identifier: MIT
// Captions of the small world's pictures: the same thing said in several ways, and seldom all of it.
#pragma once

#include "random_draw.hpp"
#include "surface_paint.hpp"
#include "world_colours.hpp"
#include "world_scene.hpp"
#include "world_shapes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples::miniature {

/// How much a caption says: what chance leaves, or all that it can.
enum class caption_length : std::uint8_t { varied, full };

namespace detail {

inline std::string chosen(random_draw& draw, std::span<std::string_view const> words) {
    return std::string(words[draw.below(static_cast<std::uint32_t>(words.size()))]);
}

inline std::string chosen(random_draw& draw, std::initializer_list<std::string_view> words) {
    return chosen(draw, std::span(words.begin(), words.size()));
}

inline std::string word_of(world_colour colour) { return std::string(colour_words[static_cast<std::size_t>(colour)]); }

inline std::string plural_of(std::string const& noun) {
    return noun == "person" ? "people" : noun + (noun.back() == 'x' ? "es" : "s");
}

inline std::string_view article_of(std::string const& words) {
    return std::string_view("aeiou").find(words.front()) == std::string_view::npos ? "a " : "an ";
}

/// The word for things that have a pattern, before a noun.
inline std::string adjective_of(random_draw& draw, surface_pattern pattern) {
    switch (pattern) {
    case surface_pattern::checker:
        return chosen(draw, {"checkered", "checked", "chequered"});
    case surface_pattern::stripes:
        return chosen(draw, {"striped", "stripy"});
    case surface_pattern::dots:
        return chosen(draw, {"dotted", "spotted", "polka dot"});
    case surface_pattern::bricks:
        return "brick";
    case surface_pattern::waves:
        return "wavy";
    case surface_pattern::plain:
        break;
    }
    return "plain";
}

/// The words for the parts of a pattern, after `with`.
inline std::string parts_of(random_draw& draw, surface_pattern pattern) {
    switch (pattern) {
    case surface_pattern::checker:
        return chosen(draw, {"checks", "squares", "checkers"});
    case surface_pattern::stripes:
        return chosen(draw, {"stripes", "bands"});
    case surface_pattern::dots:
        return chosen(draw, {"dots", "spots"});
    case surface_pattern::bricks:
        return "bricks";
    case surface_pattern::waves:
        return chosen(draw, {"waves", "wavy lines"});
    case surface_pattern::plain:
        break;
    }
    return "paint";
}

/// What the things are called, in the singular if it is one.
inline std::string noun_of(random_draw& draw, std::vector<world_shape> const& shapes) {
    auto const is_same = std::all_of(shapes.begin(), shapes.end(), [&](auto s) { return s == shapes.front(); });
    if (!is_same) {
        return chosen(draw, {"things", "shapes", "toys"});
    }
    auto noun = std::string(shape_words[static_cast<std::size_t>(shapes.front())]);
    if (shapes.front() == world_shape::figure) {
        noun = chosen(draw, {"figure", "figure", "puppet", "person"});
    } else if (shapes.front() == world_shape::ball) {
        noun = chosen(draw, {"ball", "ball", "sphere"});
    } else if (shapes.front() == world_shape::box) {
        noun = chosen(draw, {"box", "box", "cube"});
    } else if (shapes.front() == world_shape::pillar) {
        noun = chosen(draw, {"pillar", "column"});
    }
    return shapes.size() == 1 ? noun : plural_of(noun);
}

/// Which parts of a description of things are said.
struct said_parts {
    bool pattern, first, second, material;
};

inline std::string things_said(random_draw& draw, world_description const& of, said_parts said) {
    auto noun = noun_of(draw, of.shapes);
    if (said.material && of.material != surface_material::smooth) {
        noun = (of.material == surface_material::wood ? "wooden " : "stone ") + noun;
    }
    auto const counted = [&](std::string const& words) {
        constexpr std::array<std::string_view, 3> numbers{"two ", "three ", "four "};
        if (of.shapes.size() == 1) {
            return std::string(article_of(words)) + words;
        }
        return (draw.chance(0.6f) ? std::string(numbers[of.shapes.size() - 2]) : "some ") + words;
    };
    if (of.pattern == surface_pattern::plain) {
        auto const colour = said.first ? word_of(of.first) + ' ' : std::string();
        return counted((said.pattern && draw.chance(0.6f) ? "plain " : "") + colour + noun);
    }
    auto first = word_of(of.first);
    auto second = word_of(of.second);
    auto const is_even = of.pattern != surface_pattern::dots && of.pattern != surface_pattern::bricks;
    if (is_even && draw.chance(0.5f)) {
        std::swap(first, second);
    }
    if (!said.first) {
        return counted((said.pattern ? adjective_of(draw, of.pattern) + ' ' : std::string()) + noun);
    }
    if (!said.second) {
        return counted(first + ' ' + (said.pattern ? adjective_of(draw, of.pattern) + ' ' : std::string()) + noun);
    }
    auto const both = first + " and " + second;
    if (!said.pattern) {
        return draw.chance(0.7f) ? counted(both + ' ' + noun) : counted(noun) + " in " + both;
    }
    switch (draw.below(4)) {
    case 0:
        if (!is_even) {
            return of.pattern == surface_pattern::dots
                       ? counted(first + ' ' + noun) + " with " + second + ' ' + parts_of(draw, of.pattern)
                       : counted(noun) + " of " + first + " bricks with " + second + " joints";
        }
        return counted(noun) + " with " + both + ' ' + parts_of(draw, of.pattern);
    case 1:
        return counted(adjective_of(draw, of.pattern) + ' ' + noun) + " in " + both;
    default:
        return counted(both + ' ' + adjective_of(draw, of.pattern) + ' ' + noun);
    }
}

/// A ground or wall of some colour, with its pattern or without.
inline std::string backdrop_said(random_draw& draw, backdrop const& of, std::string const& noun, bool with_pattern) {
    auto words = word_of(of.colour) + ' ';
    if (with_pattern && of.pattern != surface_pattern::plain) {
        words += adjective_of(draw, of.pattern) + ' ';
    }
    return words + noun;
}

inline std::string place_said(random_draw& draw, world_description const& of, bool with_pattern) {
    if (!of.has_ground) {
        return draw.chance(0.5f) ? "in the air" : "floating in the sky";
    }
    if (!of.is_room() && !with_pattern && of.ground.pattern == surface_pattern::plain && draw.chance(0.4f)) {
        if (of.ground.colour == world_colour::green) {
            return "on grass";
        }
        if (of.ground.colour == world_colour::yellow) {
            return "on sand";
        }
        if (of.ground.colour == world_colour::white) {
            return "on snow";
        }
    }
    auto const noun = of.is_room() ? "floor" : chosen(draw, {"ground", "ground", "floor"});
    auto const words = backdrop_said(draw, of.ground, noun, with_pattern);
    return "on " + (draw.chance(0.5f) ? std::string(article_of(words)) : std::string()) + words;
}

inline std::string light_said(random_draw& draw, world_light light) {
    switch (light) {
    case world_light::clear_day:
        return chosen(draw, {"under a clear sky", "under a blue sky", "on a sunny day"});
    case world_light::clouds:
        return chosen(draw, {"under a cloudy sky", "under white clouds", "with clouds in the sky"});
    case world_light::sunset:
        return chosen(draw, {"at sunset", "in evening light", "under a sunset sky"});
    case world_light::night:
        return chosen(draw, {"at night", "in moonlight", "under a night sky"});
    case world_light::mist:
        return chosen(draw, {"in mist", "in fog", "on a misty day"});
    case world_light::lamp:
        return chosen(draw, {"in lamp light", "in warm light"});
    case world_light::room:
        break;
    }
    return chosen(draw, {"in daylight", "in a bright room"});
}

} // namespace detail

/// A caption of what is described, in lower case. Those of varied length leave out what chance says, those of full
/// length nothing but the name of a smooth material.
inline std::string draw_caption(random_draw& draw, world_description const& of,
                                caption_length length = caption_length::varied) {
    auto const says = [&](float probability) { return draw.chance(probability) || length == caption_length::full; };
    auto const first = says(0.85f);
    detail::said_parts const said{says(0.9f), first, says(0.85f) && first, says(0.6f)};
    std::vector<std::string> rest;
    if (says(0.65f)) {
        rest.push_back(detail::place_said(draw, of, says(0.6f)));
    }
    if (of.is_room() && says(0.65f)) {
        auto const plain_wall = of.wall.pattern == surface_pattern::plain && draw.chance(0.4f);
        rest.push_back(plain_wall ? "in a " + detail::word_of(of.wall.colour) + " room"
                                  : "in a room with " + detail::backdrop_said(draw, of.wall, "walls", says(0.6f)));
    }
    if (says(0.6f)) {
        rest.push_back(detail::light_said(draw, of.light));
    }
    if (rest.size() > 1 && draw.chance(0.3f)) {
        std::swap(rest.front(), rest.back());
    }
    auto caption = detail::things_said(draw, of, said);
    if (draw.chance(0.12f)) {
        caption = detail::chosen(draw, {"a picture of ", "a painting of "}) + caption;
    }
    auto const joint = draw.chance(0.35f) ? ", " : " ";
    for (auto const& part : rest) {
        caption += joint + part;
    }
    return caption;
}

} // namespace genrender::examples::miniature
