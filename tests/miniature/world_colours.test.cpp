// SPDX-License-Identifier: MIT
// Shades of the six colours, and the paints that are held out.
#include <examples/miniature/world_colours.hpp>

#include <doctest/doctest.h>

#include <set>

using namespace genrender::examples;
using namespace genrender::examples::miniature;

TEST_SUITE("miniature/world_colours") {
    TEST_CASE("hues of a third of a turn are red green and blue") {
        CHECK(glm::distance(colour_of(0, 1, 1), {1, 0, 0}) < 1e-6f);
        CHECK(glm::distance(colour_of(1.0f / 3, 1, 1), {0, 1, 0}) < 1e-5f);
        CHECK(glm::distance(colour_of(2.0f / 3, 1, 0.5f), {0, 0, 0.5f}) < 1e-5f);
        CHECK(glm::distance(colour_of(0.7f, 0, 0.25f), glm::vec3(0.25f)) < 1e-6f);
    }

    TEST_CASE("a shade is what its word says") {
        for (std::uint32_t i = 0; i < 100; ++i) {
            random_draw draw(6, i);
            auto const red = draw_shade(draw, world_colour::red);
            CHECK(red.r > 3 * std::max(red.g, red.b));
            auto const yellow = draw_shade(draw, world_colour::yellow);
            CHECK(std::min(yellow.r, yellow.g) > 2 * yellow.b);
            auto const green = draw_shade(draw, world_colour::green);
            CHECK(green.g > 1.3f * std::max(green.r, green.b));
            auto const blue = draw_shade(draw, world_colour::blue);
            CHECK(blue.b > 1.5f * std::max(blue.r, blue.g));
            auto const white = draw_shade(draw, world_colour::white);
            CHECK(std::min({white.r, white.g, white.b}) > 0.85f);
            auto const black = draw_shade(draw, world_colour::black);
            CHECK(std::max({black.r, black.g, black.b}) < 0.16f);
        }
    }

    TEST_CASE("strong shades of two colours are told apart by three tenths of a channel") {
        for (std::uint32_t i = 0; i < 50; ++i) {
            random_draw draw(7, i);
            for (std::size_t a = 0; a < colour_words.size(); ++a) {
                for (std::size_t b = 0; b < a; ++b) {
                    auto const one = draw_shade(draw, static_cast<world_colour>(a));
                    auto const difference = glm::abs(one - draw_shade(draw, static_cast<world_colour>(b)));
                    CHECK(std::max({difference.r, difference.g, difference.b}) > 0.3f);
                }
            }
        }
    }

    TEST_CASE("the quiet shade of a colour has its hue and less of it") {
        random_draw draw(8, 0);
        for (std::uint32_t i = 0; i < 50; ++i) {
            auto const loud = draw_shade(draw, world_colour::green);
            auto const quiet = draw_quiet_shade(draw, world_colour::green);
            CHECK(quiet.g > std::max(quiet.r, quiet.b));
            CHECK(std::min(quiet.r, quiet.b) / quiet.g > std::min(loud.r, loud.b) / loud.g);
        }
    }

    TEST_CASE("a seventh of the paints is held out, in either order of their colours, and no colour with itself") {
        std::size_t held_out = 0;
        for (std::size_t pattern = 1; pattern < 6; ++pattern) {
            std::set<std::size_t> of_pattern;
            for (std::size_t a = 0; a < 6; ++a) {
                for (std::size_t b = 0; b < 6; ++b) {
                    auto const first = static_cast<world_colour>(a);
                    auto const second = static_cast<world_colour>(b);
                    CHECK(is_held_out(pattern, first, second) == is_held_out(pattern, second, first));
                    held_out += is_held_out(pattern, first, second) ? 1U : 0U;
                    if (is_held_out(pattern, first, second)) {
                        of_pattern.insert(a);
                    }
                }
                CHECK_FALSE(is_held_out(pattern, static_cast<world_colour>(a), static_cast<world_colour>(a)));
            }
            CHECK(of_pattern.size() >= 2);
        }
        CHECK(held_out >= 16); // of 150
        CHECK(held_out <= 30);
    }
}
