// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The paper's correspondence: texels read and tokens that show them.
#include <genrender/correspondence/texel_grid.hpp>

#include <genrender/testing/correspondence_laws.hpp>
#include "../support/random_scene.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace genrender;

namespace {

/// Two frames of 1 x 4 pixels that see a strip of four texels; in frame 1 it moved by one pixel to the left.
uv_maps moving_strip() {
    uv_maps maps(2, {1, 4});
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t column = 0; column < 4; ++column) {
            maps.uv(i, 0, column, 0) = (static_cast<float>(column + i) + 0.5f) / 8;
            maps.uv(i, 0, column, 1) = 0.5f / 8;
            maps.coverage(i, 0, column) = 1;
        }
    }
    return maps;
}

} // namespace

TEST_SUITE("correspondence/texel_grid") {
    TEST_CASE("[GR sec. 3.2] tokens correspond when they read the same texel") {
        auto const maps = moving_strip();
        texel_grid const map(to_uv_view(maps), {1, 4}, {.T = 8});
        for (std::uint32_t t = 0; t < 4; ++t) {
            auto const point = map.point_at({0}, {t});
            REQUIRE(point.has_value());
            CHECK(map.token_at({0}, *point) == token_index{t});
            CHECK(map.token_at({1}, *point) == (t > 0 ? std::optional(token_index{t - 1}) : std::nullopt));
        }
        CHECK(map.slot_count() == 5);
    }
    TEST_CASE("equal UVs of different objects never correspond") {
        auto maps = moving_strip();
        for (std::size_t column = 0; column < 4; ++column) {
            maps.object(1, 0, column) = 1;
        }
        texel_grid const map(to_uv_view(maps), {1, 4}, {.T = 8});
        for (std::uint32_t t = 0; t < 4; ++t) {
            CHECK(!map.token_at({1}, *map.point_at({0}, {t})).has_value());
        }
    }
    TEST_CASE("objects whose numbers differ in their highest bits alone never correspond") {
        auto maps = moving_strip();
        for (std::size_t column = 0; column < 4; ++column) {
            maps.object(0, 0, column) = 3;
            maps.object(1, 0, column) = 3 + (1U << 31);
        }
        texel_grid const map(to_uv_view(maps), {1, 4}, {.T = 8});
        for (std::uint32_t t = 0; t < 4; ++t) {
            CHECK(!map.token_at({1}, *map.point_at({0}, {t})).has_value());
        }
    }
    TEST_CASE("too low a T merges points and too high a T lets nothing meet") {
        auto maps = moving_strip();
        texel_grid const coarse(to_uv_view(maps), {1, 4}, {.T = 1});
        CHECK(coarse.slot_count() == 1);
        // A shift of a third of a pixel keeps texels of a pixel's width together and parts finer ones.
        for (std::size_t column = 0; column < 4; ++column) {
            maps.uv(1, 0, column, 0) = (static_cast<float>(column) + 0.8f) / 8;
        }
        auto const meets = [&](std::size_t T) {
            texel_grid const map(to_uv_view(maps), {1, 4}, {.T = T});
            std::size_t count = 0;
            for (std::uint32_t t = 0; t < 4; ++t) {
                count += map.token_at({1}, *map.point_at({0}, {t})) ? 1U : 0U;
            }
            return count;
        };
        CHECK(meets(8) == 4);
        CHECK(meets(1024) == 0);
    }
    TEST_CASE("dilation lends a texel the nearest sample of its neighbours on the same object") {
        auto maps = moving_strip();
        for (std::size_t column = 0; column < 4; ++column) {
            maps.uv(1, 0, column, 0) = (static_cast<float>(column) + 0.8f) / 8;
        }
        texel_grid const map(to_uv_view(maps), {1, 4}, {.T = 64, .dilation = 3});
        CHECK(map.token_at({1}, *map.point_at({0}, {2})) == token_index{2});
    }
    TEST_CASE("every reading keeps the laws on random scenes") {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            auto const maps = testing::random_scene(seed, 3, {48, 32}, 3);
            for (auto const reading : {texel_reading::nearest_sample, texel_reading::average}) {
                for (std::optional<std::size_t> const T : {std::optional<std::size_t>{}, {5}, {32}}) {
                    for (std::size_t const dilation : {0U, 2U}) {
                        texel_grid const map(to_uv_view(maps), {12, 8},
                                             {.T = T, .reading = reading, .dilation = dilation});
                        auto const laws = testing::check_correspondence_laws(map);
                        CHECK(laws.text() == "");
                        CHECK(laws.shown_tokens > 50);
                    }
                }
            }
        }
    }
    TEST_CASE("compiling on two threads gives the same map") {
        auto const maps = testing::random_scene(5, 4, {64, 64}, 4);
        texel_grid const one(to_uv_view(maps), {16, 16});
        texel_grid const two(to_uv_view(maps), {16, 16}, {}, threaded_loop(2));
        for (std::uint32_t i = 0; i < 4; ++i) {
            for (std::uint32_t t = 0; t < 256; ++t) {
                REQUIRE(one.point_at({i}, {t}) == two.point_at({i}, {t}));
                if (auto const point = one.point_at({i}, {t})) {
                    REQUIRE(one.token_at({(i + 1) % 4}, *point) == two.token_at({(i + 1) % 4}, *point));
                }
            }
        }
    }
    TEST_CASE("an animation that shows nothing has no points") {
        uv_maps const maps(2, {4, 4});
        texel_grid const map(to_uv_view(maps), {2, 2});
        CHECK(map.slot_count() == 0);
        CHECK(!map.point_at({1}, {3}).has_value());
    }
    TEST_CASE("a texture without texels is refused") {
        auto const maps = moving_strip();
        CHECK_THROWS_WITH_AS(texel_grid(to_uv_view(maps), {1, 4}, {.T = 0}),
                             "texture_resolution: T is 0, expected 1 to 1048576 texels", value_error);
    }
    TEST_CASE("UVs that are not finite are refused by name") {
        auto maps = moving_strip();
        maps.uv(0, 0, 0, 0) = std::numeric_limits<float>::infinity();
        CHECK_THROWS_WITH_AS(texel_grid(to_uv_view(maps), {1, 4}, {.T = 8}),
                             "texel_of: uv is inf, expected finite texture coordinates", value_error);
    }
}
