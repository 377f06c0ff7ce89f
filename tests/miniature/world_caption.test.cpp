// SPDX-License-Identifier: MIT
// Captions: what they say is true, what they must say is said, and one thing is said in several ways.
#include <examples/miniature/world_caption.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

using namespace genrender::examples;
using namespace genrender::examples::miniature;

namespace {

world_description red_white_balls() {
    world_description of;
    of.shapes = {world_shape::ball, world_shape::ball};
    of.pattern = surface_pattern::checker;
    of.first = world_colour::red;
    of.second = world_colour::white;
    of.light = world_light::night;
    of.ground.colour = world_colour::green;
    of.wall.colour = world_colour::blue;
    return of;
}

std::set<std::string> words_of(std::string caption) {
    std::replace(caption.begin(), caption.end(), ',', ' ');
    std::istringstream text(caption);
    return {std::istream_iterator<std::string>(text), {}};
}

std::string caption_of(world_description const& of, std::uint32_t number, caption_length length) {
    random_draw draw(11, number);
    return draw_caption(draw, of, length);
}

} // namespace

TEST_SUITE("miniature/world_caption") {
    TEST_CASE("a full caption names both colours, pattern, ground and light") {
        for (std::uint32_t i = 0; i < 100; ++i) {
            auto const words = words_of(caption_of(red_white_balls(), i, caption_length::full));
            for (auto const* const word : {"red", "white", "green"}) {
                CHECK(words.count(word) == 1);
            }
            CHECK(words.count("checkered") + words.count("checked") + words.count("chequered") + words.count("checks") +
                      words.count("squares") + words.count("checkers") ==
                  1);
            CHECK(words.count("night") + words.count("moonlight") == 1);
        }
    }

    TEST_CASE("captions say nothing that is not so") {
        for (std::uint32_t i = 0; i < 200; ++i) {
            auto const words = words_of(caption_of(red_white_balls(), i, caption_length::varied));
            for (auto const* const word : {"blue", "yellow", "black", "walls", "striped", "box", "wooden", "three"}) {
                CHECK(words.count(word) == 0);
            }
        }
    }

    TEST_CASE("captions of one picture differ and leave out what others say") {
        std::set<std::string> found;
        auto without_colour = 0;
        for (std::uint32_t i = 0; i < 200; ++i) {
            auto const caption = caption_of(red_white_balls(), i, caption_length::varied);
            found.insert(caption);
            without_colour += words_of(caption).count("red") == 0 ? 1 : 0;
        }
        CHECK(found.size() > 100);
        CHECK(without_colour > 10);
        CHECK(without_colour < 100);
    }

    TEST_CASE("dots are of the second colour and stand on the first") {
        auto of = red_white_balls();
        of.pattern = surface_pattern::dots;
        for (std::uint32_t i = 0; i < 100; ++i) {
            auto const caption = caption_of(of, i, caption_length::full);
            CHECK(caption.find("white and red") == std::string::npos);
            CHECK(caption.find("red dots") == std::string::npos);
            CHECK(caption.find("red spots") == std::string::npos);
        }
    }

    TEST_CASE("an article fits its noun and several things have a plural") {
        auto of = red_white_balls();
        of.shapes = {world_shape::egg};
        auto found = false;
        for (std::uint32_t i = 0; i < 100; ++i) {
            auto const caption = caption_of(of, i, caption_length::varied);
            CHECK(caption.find("a egg") == std::string::npos);
            found = found || caption.find("an egg") != std::string::npos;
        }
        CHECK(found);
        of.shapes = {world_shape::box, world_shape::box, world_shape::box};
        for (std::uint32_t i = 0; i < 30; ++i) {
            auto const words = words_of(caption_of(of, i, caption_length::varied));
            CHECK(words.count("boxes") + words.count("cubes") == 1);
        }
    }

    TEST_CASE("things of several shapes have a common name") {
        auto of = red_white_balls();
        of.shapes = {world_shape::egg, world_shape::box};
        for (std::uint32_t i = 0; i < 30; ++i) {
            auto const words = words_of(caption_of(of, i, caption_length::varied));
            CHECK(words.count("things") + words.count("shapes") + words.count("toys") == 1);
        }
    }
}
