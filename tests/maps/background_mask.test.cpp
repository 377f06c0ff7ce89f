// SPDX-License-Identifier: MIT
// A cell is background only if no object touches it.
#include <genrender/maps/background_mask.hpp>

#include <genrender/maps/uv_maps.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

TEST_SUITE("maps/background_mask") {
    using namespace genrender;

    TEST_CASE("[GR sec. 3.4] one covered pixel takes its cell out of the background") {
        uv_maps maps(2, {4, 6});
        maps.coverage(0, 1, 3) = 1;
        maps.coverage(1, 3, 5) = 1;
        auto const mask = background_mask(to_uv_view(maps), {2, 3});
        CHECK(mask == tensor<std::uint8_t, 3>{{{1, 0, 1}, {1, 1, 1}}, {{1, 1, 1}, {1, 1, 0}}});
    }

    TEST_CASE("at full resolution the mask is what coverage is not") {
        uv_maps maps(1, {2, 2});
        maps.coverage(0, 0, 1) = 1;
        CHECK(background_mask(to_uv_view(maps), {2, 2}) == tensor<std::uint8_t, 3>{{{1, 0}, {1, 1}}});
    }

    TEST_CASE("an empty animation is all background and a full one has none") {
        uv_maps maps(1, {4, 4});
        CHECK(background_mask(to_uv_view(maps), {1, 1})(0, 0, 0) == 1);
        maps.coverage.fill(1);
        CHECK(background_mask(to_uv_view(maps), {1, 1})(0, 0, 0) == 0);
    }

    TEST_CASE("a grid that does not divide the maps is refused by name") {
        uv_maps const maps(1, {16, 16});
        CHECK_THROWS_WITH_AS(background_mask(to_uv_view(maps), {3, 4}),
                             "background_mask: grid is [3, 4], expected extents that divide the maps' [16, 16]",
                             value_error);
        CHECK_THROWS_AS(background_mask(to_uv_view(maps), {4, 5}), value_error);
        CHECK_THROWS_AS(background_mask(to_uv_view(maps), {0, 4}), value_error);
    }

    TEST_CASE("background is open where no object is near") {
        // One object, in the second column of the first row.
        std::vector<std::uint8_t> const mask{1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
        strided_view<std::uint8_t const, 3> const background(mask.data(), {1, 3, 5});
        auto const open_at = [&](std::size_t distance) {
            auto const open = open_background(background, distance);
            return std::vector<std::uint8_t>(open.data(), open.data() + open.size());
        };
        CHECK(open_at(0) == mask);
        CHECK(open_at(1) == std::vector<std::uint8_t>{0, 0, 0, 1, 1, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1});
        CHECK(open_at(2) == std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
        CHECK(open_at(9) == std::vector<std::uint8_t>(15, 0));
    }
}
