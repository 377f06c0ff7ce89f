// SPDX-License-Identifier: MIT
// What the compared animations shall look like: paints that training never showed, as descriptions and as texts.
#pragma once

#include <examples/miniature/surface_paint.hpp>
#include <examples/miniature/world_colours.hpp>
#include <examples/miniature/world_scene.hpp>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// Which scenes, captions and seeds: those that settings are chosen on, or those that methods are compared on. They have
/// nothing in common with each other, nor with the training's.
enum class scene_set { held_out, development };

/// A caption's facts.
struct compared_caption {
    miniature::surface_pattern pattern; ///< of all that stands out
    miniature::world_colour first;      ///< of its two colours
    miniature::world_colour second;
    miniature::world_colour ground; ///< plain
    miniature::world_light light;
};

/// The captions of a set. Each has a pattern in two colours that the training of denoiser and embedder never showed
/// (miniature::is_held_out), and no two sets share one.
inline std::array<compared_caption, 4> captions_of(scene_set set) {
    using miniature::surface_pattern;
    using miniature::world_colour;
    using miniature::world_light;
    if (set == scene_set::development) {
        return {{{surface_pattern::stripes, world_colour::red, world_colour::blue, world_colour::green,
                  world_light::clear_day},
                 {surface_pattern::checker, world_colour::yellow, world_colour::green, world_colour::white,
                  world_light::clouds},
                 {surface_pattern::dots, world_colour::black, world_colour::yellow, world_colour::green,
                  world_light::clear_day},
                 {surface_pattern::bricks, world_colour::blue, world_colour::white, world_colour::yellow,
                  world_light::clouds}}};
    }
    return {
        {{surface_pattern::stripes, world_colour::green, world_colour::white, world_colour::yellow,
          world_light::clear_day},
         {surface_pattern::checker, world_colour::red, world_colour::black, world_colour::green, world_light::clouds},
         {surface_pattern::dots, world_colour::yellow, world_colour::red, world_colour::green, world_light::clear_day},
         {surface_pattern::waves, world_colour::red, world_colour::white, world_colour::yellow, world_light::clouds}}};
}

/// How a caption names what stands out in a scene.
struct subject_words {
    std::string before; ///< an article or a number
    std::string noun;
};

namespace detail {

/// The adjective for a pattern, which captions and questions have.
inline std::string_view pattern_word(miniature::surface_pattern pattern) {
    constexpr std::array<std::string_view, miniature::pattern_names.size()> words{"plain",  "checkered", "striped",
                                                                                  "dotted", "brick",     "wavy"};
    return words[static_cast<std::size_t>(pattern)];
}

inline std::string colour_word(miniature::world_colour colour) {
    return std::string(miniature::colour_words[static_cast<std::size_t>(colour)]);
}

} // namespace detail

/// The prompt of a run: `a green and white striped figure on yellow ground under a clear sky`.
inline std::string text_of(compared_caption const& caption, subject_words const& subject) {
    auto const* const light =
        caption.light == miniature::world_light::clouds ? "under a cloudy sky" : "under a clear sky";
    return subject.before + ' ' + detail::colour_word(caption.first) + " and " + detail::colour_word(caption.second) +
           ' ' + std::string(detail::pattern_word(caption.pattern)) + ' ' + subject.noun + " on " +
           detail::colour_word(caption.ground) + " ground " + light;
}

/// A question to the embedder: the texts that it has to choose from, and the row of the true one.
struct recognition_question {
    std::vector<std::string> texts;
    std::size_t truth;
};

/// Which of the six patterns.
inline recognition_question pattern_question(compared_caption const& caption) {
    recognition_question question{{}, static_cast<std::size_t>(caption.pattern)};
    for (std::size_t p = 0; p < miniature::pattern_names.size(); ++p) {
        question.texts.push_back("a " + std::string(detail::pattern_word(static_cast<miniature::surface_pattern>(p))) +
                                 " ball");
    }
    return question;
}

/// Which of the fifteen pairs of colours.
inline recognition_question colours_question(compared_caption const& caption) {
    recognition_question question{{}, 0};
    for (std::size_t a = 0; a < miniature::colour_words.size(); ++a) {
        for (auto b = a + 1; b < miniature::colour_words.size(); ++b) {
            auto const first = static_cast<miniature::world_colour>(a);
            auto const second = static_cast<miniature::world_colour>(b);
            if ((first == caption.first && second == caption.second) ||
                (first == caption.second && second == caption.first)) {
                question.truth = question.texts.size();
            }
            question.texts.push_back("a " + detail::colour_word(first) + " and " + detail::colour_word(second) +
                                     " ball");
        }
    }
    return question;
}

} // namespace genrender::examples
