// SPDX-License-Identifier: MIT
// A frame has samples of every cell and object: the pixels nearest to the middles of the cell's parts.
#include <genrender/correspondence/frame_samples.hpp>

#include "../support/random_scene.hpp"
#include "../support/small_maps.hpp"

#include <genrender/correspondence/representative_pixel.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>

using namespace genrender;

namespace {

template <class Maps>
frame_samples<2> samples_in(Maps const& maps, grid_extents grid) {
    return {maps, {0}, grid, 1, [&](token_index token) { return representative_pixel(maps, {0}, grid, token); }};
}

/// One object on a plane of 16 x 16 pixels, a 32th apart.
uv_maps plane() {
    uv_maps maps(1, {16, 16});
    maps.coverage.fill(1);
    for (std::size_t row = 0; row < 16; ++row) {
        for (std::size_t column = 0; column < 16; ++column) {
            maps.uv(0, row, column, 0) = static_cast<float>(column) / 32;
            maps.uv(0, row, column, 1) = static_cast<float>(row) / 32;
        }
    }
    return maps;
}

footprint_point<2> place(float u, float v) {
    return {{0}, {u, v}, surface_footprint<2>{{1.0F / 32, 0}, {0, 1.0F / 32}}};
}

} // namespace

TEST_SUITE("correspondence/frame_samples") {
    TEST_CASE("every pixel of a small cell is a sample, with the share of the cell and the pixels a unit of surface") {
        auto maps = plane();
        for (std::size_t row = 0; row < 4; ++row) {
            maps.coverage(0, row, 3) = 0; // a quarter of the first cell
        }
        auto const frame = samples_in(to_uv_view(maps), {4, 4});
        REQUIRE(frame.samples_of({0}) != nullptr);
        CHECK(frame.samples_of({1}) == nullptr);
        auto const& samples = *frame.samples_of({0});
        for (std::size_t row = 0; row < 16; ++row) {
            for (std::size_t column = 0; column < 16; ++column) {
                auto const* const sample =
                    samples.sample_of(place(static_cast<float>(column) / 32, static_cast<float>(row) / 32));
                REQUIRE(sample != nullptr);
                auto const& match = sample->match;
                if (row >= 4 || column != 3) {
                    CHECK(match.token.value == row / 4 * 4 + column / 4);
                }
                CHECK(match.quality == (match.token.value == 0 ? 0.75F * 1024 : 1024.0F));
            }
        }
    }

    TEST_CASE("of large cells four by four pixels and the representative are samples") {
        // One cell of 16 x 16: parts of 4 x 4 whose middles lie between pixels; the upper left of the four is taken.
        auto const maps = plane();
        auto const frame = samples_in(to_uv_view(maps), {1, 1});
        auto const& samples = *frame.samples_of({0});
        // Each sample is found at its own place.
        std::set<std::array<float, 2>> places;
        for (std::size_t row = 0; row < 16; ++row) {
            for (std::size_t column = 0; column < 16; ++column) {
                auto const* const sample =
                    samples.sample_of(place(static_cast<float>(column) / 32, static_cast<float>(row) / 32));
                REQUIRE(sample != nullptr);
                places.insert(sample->place);
            }
        }
        CHECK(places.size() == 17); // the representative (7, 7) is none of the sixteen
    }

    TEST_CASE("objects of a cell have samples of their own") {
        auto const scene = testing::random_scene(5, 1, {48, 48}, 3);
        auto const maps = to_uv_view(scene);
        auto const frame = samples_in(maps, {12, 12});
        std::size_t own = 0;
        for (std::uint32_t row = 0; row < 48; ++row) {
            for (std::uint32_t column = 0; column < 48; ++column) {
                if (maps.is_covered({0}, {row, column})) {
                    auto const* const samples = frame.samples_of(maps.object_at({0}, {row, column}));
                    REQUIRE(samples != nullptr);
                    auto const* const sample =
                        samples->sample_of({maps.object_at({0}, {row, column}), maps.point_at({0}, {row, column}),
                                            footprint_at(maps, {0}, {row, column})});
                    REQUIRE(sample != nullptr);
                    own += sample->match.token.value == row / 4 * 12 + column / 4 ? 1U : 0U;
                }
            }
        }
        CHECK(own > 500);
    }

    TEST_CASE("coordinates that are not finite are refused") {
        auto maps = plane();
        maps.uv(0, 5, 5, 1) = std::numeric_limits<float>::quiet_NaN();
        CHECK_THROWS_WITH_AS(samples_in(to_uv_view(maps), {4, 4}),
                             "frame_samples: maps is nan, expected finite canonical coordinates", value_error);
    }

    TEST_CASE("a surface too small for numbers has the greatest quality and one without neighbours none") {
        auto maps = plane();
        for (auto& coordinate : maps.uv) {
            coordinate *= 1e-19F;
        }
        auto const tiny = samples_in(to_uv_view(maps), {4, 4});
        auto const* const sample = tiny.samples_of({0})->sample_of({{0}, {0, 0}, std::nullopt});
        REQUIRE(sample != nullptr);
        CHECK(sample->match.quality == std::numeric_limits<float>::max());
        maps = plane();
        maps.coverage.fill(0);
        maps.coverage(0, 5, 5) = 1;
        auto const isolated = samples_in(to_uv_view(maps), {4, 4});
        auto const* const alone = isolated.samples_of({0})->sample_of({{0}, {5.0F / 32, 5.0F / 32}, std::nullopt});
        REQUIRE(alone != nullptr);
        CHECK(alone->match.quality == 0);
        CHECK(alone->match.token == token_index{5});
    }
}
