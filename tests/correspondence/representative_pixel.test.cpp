// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The pixel that stands for a token, in pictures.
#include <genrender/correspondence/representative_pixel.hpp>

#include "../support/small_maps.hpp"

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <optional>
#include <string>

using namespace genrender;

namespace {

/// The pixel for the only token of a picture.
std::optional<pixel> representative_of(std::string const& picture) {
    auto const maps = testing::drawn_maps({picture});
    return representative_pixel(to_uv_view(maps), {0}, {1, 1}, {0});
}

} // namespace

TEST_SUITE("correspondence/representative_pixel") {
    TEST_CASE("[GR sec. 3.2] the pixel nearest to the centre stands for the token") {
        CHECK(representative_of("aaa aaa aaa") == pixel{1, 1});
        // Four are equally near in a cell of even extents: the lowest row and column win.
        CHECK(representative_of("aaaa aaaa aaaa aaaa") == pixel{1, 1});
        CHECK(representative_of("aaaaaa aaaaaa") == pixel{0, 2});
        CHECK(representative_of("a") == pixel{0, 0});
    }

    TEST_CASE("[GR sec. 3.2] pixels are those of the token's own cell") {
        auto const maps = testing::drawn_maps({"aaaaaa aaaaaa aaaaaa aaaaaa", "bbbbbb bbbbbb bbbbbb bb...."});
        CHECK(representative_pixel(to_uv_view(maps), {0}, {2, 2}, {0}) == pixel{0, 1});
        CHECK(representative_pixel(to_uv_view(maps), {0}, {2, 2}, {1}) == pixel{0, 4});
        CHECK(representative_pixel(to_uv_view(maps), {0}, {2, 2}, {2}) == pixel{2, 1});
        CHECK(representative_pixel(to_uv_view(maps), {0}, {2, 2}, {3}) == pixel{2, 4});
        CHECK(representative_pixel(to_uv_view(maps), {1}, {4, 2}, {6}) == pixel{3, 1});
        CHECK_FALSE(representative_pixel(to_uv_view(maps), {1}, {4, 2}, {7}).has_value());
    }

    TEST_CASE("the object with most pixels owns the cell and ties go to the lowest number") {
        CHECK(representative_of("bba baa aaa") == pixel{1, 1});
        CHECK(representative_of("bbb bab aaa") == pixel{0, 1}); // the centre belongs to the one that lost
        CHECK(representative_of("bb aa") == pixel{1, 0});
        CHECK(representative_of("bb ca") == pixel{0, 0});
        CHECK(representative_of("ccc bba aaa") == pixel{1, 2});
    }

    TEST_CASE("a cell with more background than objects shows nothing") {
        CHECK(representative_of(".. aa") == pixel{1, 0});
        CHECK_FALSE(representative_of(".. .a").has_value());
        CHECK_FALSE(representative_of(".. ..").has_value());
        // All objects together are counted against the background; then the greatest of them owns the cell.
        CHECK(representative_of(".... ..cb aacb") == pixel{2, 1});
        CHECK_FALSE(representative_of(".... ...b aacb").has_value());
    }

    TEST_CASE("rest positions and UVs give the same pixel") {
        auto const maps = testing::drawn_maps({"a.ba bb.a aabb .bb."});
        stack<float, 4> const position({1, 4, 4, 3});
        position_maps_view const in_space(position.view(), to_view(maps.object), to_view(maps.coverage));
        std::size_t shown = 0;
        for (std::uint32_t t = 0; t < 4; ++t) {
            auto const p = representative_pixel(to_uv_view(maps), {0}, {2, 2}, {t});
            CHECK(representative_pixel(in_space, {0}, {2, 2}, {t}) == p);
            shown += p ? 1U : 0U;
        }
        CHECK(shown == 4);
    }

    TEST_CASE("grids that do not divide the maps are refused by the pixel's name") {
        auto const maps = testing::drawn_maps({"aaaa aaaa aaaa aaaa"});
        CHECK_THROWS_WITH_AS(representative_pixel(to_uv_view(maps), {0}, {3, 2}, {0}),
                             "representative_pixel: grid is [3, 2], expected extents that divide the maps' [4, 4]",
                             value_error);
        CHECK_THROWS_WITH_AS(representative_pixel(to_uv_view(maps), {0}, {0, 2}, {0}),
                             "representative_pixel: grid is [0, 2], expected extents that divide the maps' [4, 4]",
                             value_error);
    }
}
