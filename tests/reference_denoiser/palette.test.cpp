// SPDX-License-Identifier: MIT
// What surfaces are painted with: hues, names, pairs that are held out.
#include <examples/reference_denoiser/palette.hpp>

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::examples;

TEST_SUITE("reference_denoiser/palette") {
    TEST_CASE("hues of a third of a turn are red green and blue") {
        CHECK(glm::distance(colour_of(0, 1, 1), {1, 0, 0}) < 1e-6f);
        CHECK(glm::distance(colour_of(1.0f / 3, 1, 1), {0, 1, 0}) < 1e-5f);
        CHECK(glm::distance(colour_of(2.0f / 3, 1, 0.5f), {0, 0, 0.5f}) < 1e-5f);
        CHECK(glm::distance(colour_of(0.7f, 0, 0.25f), glm::vec3(0.25f)) < 1e-6f);
    }

    TEST_CASE("the two colours of a palette are told apart by their brightness") {
        for (std::uint32_t i = 0; i < 200; ++i) {
            random_draw draw(5, i);
            auto const drawn = draw_palette(draw, {}, palette_set::training);
            CHECK(std::abs(luma(drawn.first) - luma(drawn.second)) >= 0.3f);
        }
    }

    TEST_CASE("a named colour is the first of a palette") {
        for (std::uint32_t i = 0; i < 100; ++i) {
            random_draw draw(6, i);
            auto const red = draw_palette(draw, 0, palette_set::training).first;
            CHECK(red.r > 2 * red.g);
            CHECK(red.r > 2 * red.b);
            auto const blue = draw_palette(draw, 3, palette_set::training).first;
            CHECK(blue.b > 1.3f * blue.g);
            CHECK(blue.b > 2 * blue.r);
            auto const white = draw_palette(draw, 5, palette_set::training).first;
            CHECK(std::min({white.r, white.g, white.b}) > 0.8f);
        }
    }

    TEST_CASE("pairs of hues that are held out are about a seventh and never drawn for training") {
        auto held_out = 0;
        for (int first = 0; first < 12; ++first) {
            for (int second = 0; second < 12; ++second) {
                held_out += examples::detail::is_held_out((static_cast<float>(first) + 0.5f) / 12,
                                                          (static_cast<float>(second) + 0.5f) / 12)
                                ? 1
                                : 0;
            }
        }
        CHECK(held_out == 21); // of 144
        CHECK(examples::detail::is_held_out(0.01f, 0.01f));
        CHECK_FALSE(examples::detail::is_held_out(0.01f, 0.1f));
    }
}
