// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The sample that stands for a token.
#include <genrender/correspondence/surface_sample.hpp>

#include "../support/random_scene.hpp"

#include <genrender/maps/uv_maps.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <limits>

using namespace genrender;

namespace {

/// One frame of 4 x 4 pixels, all of object 5, with u = column / 4 and v = row / 4 at the pixels' upper left corners.
uv_maps full_frame() {
    uv_maps maps(1, {4, 4});
    for (std::size_t row = 0; row < 4; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            maps.uv(0, row, column, 0) = static_cast<float>(column) / 4;
            maps.uv(0, row, column, 1) = static_cast<float>(row) / 4;
            maps.object(0, row, column) = 5;
            maps.coverage(0, row, column) = 1;
        }
    }
    return maps;
}

} // namespace

TEST_SUITE("correspondence/surface_sample") {
    TEST_CASE("the sample is a pixel of the cell and never an average") {
        auto const maps = full_frame();
        auto const sample = representative_sample(to_uv_view(maps), {0}, {2, 2}, {3});
        REQUIRE(sample.has_value());
        // All four pixels of the cell are equally near to its centre: the lowest row and column win.
        CHECK(sample->at == pixel{2, 2});
        CHECK(sample->uv[0] == 0.5f);
        CHECK(sample->uv[1] == 0.5f);
        CHECK(sample->object == object_index{5});
    }
    TEST_CASE("[GR sec. 3.2] the sample is what the representative pixel shows") {
        auto const maps = testing::random_scene(3, 2, {24, 32}, 3);
        std::size_t shown = 0;
        for (std::uint32_t t = 0; t < 48; ++t) {
            auto const p = representative_pixel(to_uv_view(maps), {1}, {6, 8}, {t});
            auto const sample = representative_sample(to_uv_view(maps), {1}, {6, 8}, {t});
            REQUIRE(sample.has_value() == p.has_value());
            if (p) {
                CHECK(sample->at == *p);
                CHECK(sample->object == object_index{maps.object(1, p->row, p->column)});
                CHECK(sample->uv[0] == maps.uv(1, p->row, p->column, 0));
                CHECK(sample->uv[1] == maps.uv(1, p->row, p->column, 1));
                ++shown;
            }
        }
        CHECK(shown > 10);
        CHECK(shown < 48);
    }
    TEST_CASE("texel centres lie at one half and coordinates outside go to the border") {
        auto const T = texture_resolution::same(4);
        auto const at = [&](float u, float v) { return texel_of({{0}, {u, v}, {}}, T); };
        CHECK(at(0.125f, 0.625f) == texel{{0}, 2, 0});
        CHECK(at(0.25f, 0.2499f) == texel{{0}, 0, 1});
        CHECK(at(1.0f, -3.0f) == texel{{0}, 0, 3});
        CHECK(at(1e30f, 0.0f) == texel{{0}, 0, 3});
        CHECK_THROWS_WITH_AS(at(std::numeric_limits<float>::quiet_NaN(), 0),
                             "texel_of: uv is nan, expected finite texture coordinates", value_error);
    }
    TEST_CASE("grids that do not divide the maps are refused by name") {
        auto const maps = full_frame();
        CHECK_THROWS_WITH_AS(representative_sample(to_uv_view(maps), {0}, {3, 2}, {0}),
                             "representative_pixel: grid is [3, 2], expected extents that divide the maps' [4, 4]",
                             value_error);
    }
}
