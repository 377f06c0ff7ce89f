// SPDX-License-Identifier: MIT
// Captions whose paints are held out, from training and from each other's set.
#include <examples/evaluation/caption.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string>
#include <tuple>

using namespace genrender::examples;

TEST_SUITE("evaluation_program/caption") {
    TEST_CASE("training shows none of the paints, and the two sets of captions share none") {
        std::set<std::tuple<int, int, int>> paints;
        for (auto const set : {scene_set::held_out, scene_set::development}) {
            for (auto const& caption : captions_of(set)) {
                CHECK(miniature::is_held_out(static_cast<std::size_t>(caption.pattern), caption.first, caption.second));
                auto const [low, high] =
                    std::minmax({static_cast<int>(caption.first), static_cast<int>(caption.second)});
                CHECK(paints.insert({static_cast<int>(caption.pattern), low, high}).second);
                CHECK(caption.ground != caption.first);
                CHECK(caption.ground != caption.second);
            }
        }
        CHECK(paints.size() == 8);
    }

    TEST_CASE("a caption says pattern, colours, ground and light of a scene's things") {
        auto const caption = captions_of(scene_set::held_out)[0];
        CHECK(text_of(caption, {"a", "figure"}) ==
              "a green and white striped figure on yellow ground under a clear sky");
        CHECK(text_of(captions_of(scene_set::development)[3], {"some", "things"}) ==
              "some blue and white brick things on yellow ground under a cloudy sky");
    }

    TEST_CASE("the true text of a question says what the caption does") {
        for (auto const& caption : captions_of(scene_set::held_out)) {
            auto const pattern = pattern_question(caption);
            auto const colours = colours_question(caption);
            CHECK(pattern.texts.size() == 6);
            CHECK(colours.texts.size() == 15);
            CHECK(std::set<std::string>(colours.texts.begin(), colours.texts.end()).size() == 15);
            auto const text = text_of(caption, {"a", "ball"});
            auto const word = pattern.texts.at(pattern.truth).substr(2);
            CHECK(text.find(word) != std::string::npos);
            auto const named = colours.texts.at(colours.truth);
            for (auto const colour : {caption.first, caption.second}) {
                CHECK(named.find(miniature::colour_words[static_cast<std::size_t>(colour)]) != std::string::npos);
            }
        }
    }
}
