// SPDX-License-Identifier: MIT
// [GR sec. 3.2] T by hand and T by density.
#include <genrender/correspondence/texture_resolution.hpp>

#include <genrender/maps/uv_maps.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("correspondence/texture_resolution") {
    TEST_CASE("one T serves all objects") {
        auto const T = texture_resolution::same(64);
        CHECK(T.of({0}) == 64);
        CHECK(T.of({7}) == 64);
        CHECK_THROWS_WITH_AS(texture_resolution::same(0), "texture_resolution: T is 0, expected 1 to 1048576 texels",
                             value_error);
        CHECK_THROWS_AS(texture_resolution::same((std::size_t{1} << 20) + 1), value_error);
    }
    TEST_CASE("a matched T follows how densely each object is shown") {
        // Object 1 spans its whole texture over 32 pixels, object 2 half of its own over 32 pixels.
        uv_maps maps(2, {32, 64});
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t row = 0; row < 32; ++row) {
                for (std::size_t column = 0; column < 64; ++column) {
                    auto const scale = column < 32 ? 32.0f : 64.0f;
                    maps.uv(i, row, column, 0) = static_cast<float>(column % 32) / scale;
                    maps.uv(i, row, column, 1) = static_cast<float>(row) / scale;
                    maps.object(i, row, column) = column < 32 ? 1 : 2;
                    maps.coverage(i, row, column) = 1;
                }
            }
        }
        auto const T = texture_resolution::matched(to_uv_view(maps), {8, 16}, 2);
        CHECK(T.of({1}) == 16); // 8 tokens across, 2 texels each
        CHECK(T.of({2}) == 32);
        CHECK(T.of({3}) == 1);
    }
    TEST_CASE("an object that one pixel shows and a constant UV still give a texture") {
        uv_maps maps(1, {4, 4});
        maps.coverage(0, 1, 1) = 1;
        CHECK(texture_resolution::matched(to_uv_view(maps), {2, 2}, 1).of({0}) == 1);
        maps.coverage.fill(1);
        CHECK(texture_resolution::matched(to_uv_view(maps), {2, 2}, 1).of({0}) == texture_resolution::greatest);
        CHECK_THROWS_WITH_AS(texture_resolution::matched(to_uv_view(maps), {2, 2}, 0),
                             "texture_resolution: texels_per_token is 0.000000, expected above 0", value_error);
    }
}
