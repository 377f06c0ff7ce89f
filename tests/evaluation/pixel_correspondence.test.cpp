// SPDX-License-Identifier: MIT
// Pixels that correspond are close, correspond both ways, and are seen in both frames.
#include <genrender/evaluation/pixel_correspondence.hpp>

#include <genrender/correspondence/reproject.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <doctest/doctest.h>

#include <genrender/testing/correspondence_laws.hpp>
#include "support/random_scene.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

using namespace genrender;
using genrender::testing::check_correspondence_laws;
using genrender::testing::random_scene;

namespace {

constexpr grid_extents plane_maps{32, 64};
constexpr grid_extents plane_image{8, 16}; // a pixel is a square of 4 x 4 map pixels

/// A plane whose texture moves to the right by `shifts[i]` map pixels in frame i; 80 map pixels make one texture.
uv_maps sliding_plane(std::vector<double> const& shifts) {
    uv_maps maps(shifts.size(), plane_maps);
    maps.coverage.fill(1);
    for (std::size_t i = 0; i < shifts.size(); ++i) {
        for (std::size_t row = 0; row < plane_maps.height; ++row) {
            for (std::size_t column = 0; column < plane_maps.width; ++column) {
                maps.uv(i, row, column, 0) = static_cast<float>((static_cast<double>(column) + 8 - shifts[i]) / 80);
                maps.uv(i, row, column, 1) = static_cast<float>((static_cast<double>(row) + 8) / 80);
            }
        }
    }
    return maps;
}

/// How many pixels of frame 1 correspond to the one `right` pixels left of them in frame 0; each that corresponds must.
std::size_t pairs_at(pixel_correspondence const& map, std::uint32_t right) {
    std::size_t pairs = 0;
    for (std::uint32_t p = 0; p < map.grid().size(); ++p) {
        if (auto const q = corresponding_token(map, {0}, {1}, {p})) {
            CHECK(q->value + right == p);
            ++pairs;
        }
    }
    return pairs;
}

} // namespace

TEST_SUITE("evaluation/pixel_correspondence") {
    TEST_CASE("[GR sec. 4] it keeps the laws of correspondence") {
        static_assert(correspondence_map<pixel_correspondence>);
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            auto const maps = random_scene(seed, 3, {48, 48}, 3);
            auto const coarse = check_correspondence_laws(pixel_correspondence(to_uv_view(maps), {24, 24}));
            CHECK(coarse.text() == "");
            CHECK(coarse.shown_tokens > 100);
            auto const fine = check_correspondence_laws(pixel_correspondence(to_uv_view(maps), {48, 48}));
            CHECK(fine.text() == "");
            CHECK(fine.shown_tokens > 1000);
        }
    }

    TEST_CASE("[GR sec. 4] a plane that moves by whole pixels corresponds pixel by pixel") {
        auto const maps = sliding_plane({0, 4});
        CHECK(pairs_at(pixel_correspondence(to_uv_view(maps), plane_image), 1) == 8 * 15);
        auto const further = sliding_plane({0, 12});
        CHECK(pairs_at(pixel_correspondence(to_uv_view(further), plane_image), 3) == 8 * 13);
    }

    TEST_CASE("[GR sec. 4] pairs lie within reach of a pixel's middle") {
        // The texture moves by 1.2 and by 1.4 pixels.
        auto const maps = sliding_plane({0, 4.8});
        CHECK(pairs_at(pixel_correspondence(to_uv_view(maps), plane_image, 0.19), 1) == 0);
        CHECK(pairs_at(pixel_correspondence(to_uv_view(maps), plane_image, 0.21), 1) == 8 * 15);
        auto const further = sliding_plane({0, 5.6});
        CHECK(pairs_at(pixel_correspondence(to_uv_view(further), plane_image), 1) == 0);
        CHECK(pairs_at(pixel_correspondence(to_uv_view(further), plane_image, 0.5), 1) == 8 * 15);
    }

    TEST_CASE("[GR sec. 4] where a point lies is told in pixels by hand") {
        auto const maps = sliding_plane({0});
        pixel_correspondence const map(to_uv_view(maps), plane_image);
        auto const point = map.point_at({0}, {16 + 2}); // row 1, column 2: map pixel (5, 9)
        REQUIRE(point.has_value());
        CHECK(point->uv[0] == doctest::Approx(17.0 / 80));
        CHECK(point->uv[1] == doctest::Approx(13.0 / 80));
        CHECK(point->across[0] == doctest::Approx(4.0 / 80));
        CHECK(point->down[1] == doctest::Approx(4.0 / 80));
        CHECK(point->area() == doctest::Approx(16.0 / 6400));
        auto other = *point;
        other.uv[0] += 1.0F / 80;
        other.uv[1] -= 2.0F / 80;
        CHECK(point->offset_of(other) == doctest::Approx(0.5));
    }

    TEST_CASE("[GR sec. 4] that two pixels correspond does not depend on which is asked") {
        std::size_t pairs = 0;
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            auto const maps = random_scene(seed, 2, {64, 64}, 3);
            pixel_correspondence const map(to_uv_view(maps), {16, 16}, 0.3);
            for (std::uint32_t p = 0; p < map.grid().size(); ++p) {
                if (auto const q = corresponding_token(map, {0}, {1}, {p})) {
                    auto const a = *map.point_at({1}, {p});
                    auto const b = *map.point_at({0}, *q);
                    CHECK(a.object == b.object);
                    CHECK(std::max(a.offset_of(b), b.offset_of(a)) <= 0.3);
                    CHECK(corresponding_token(map, {1}, {0}, *q).has_value());
                    ++pairs;
                }
            }
        }
        CHECK(pairs > 50);
    }

    TEST_CASE("[GR sec. 4] what is hidden by another object does not correspond") {
        auto maps = sliding_plane({0, 0});
        for (std::size_t row = 0; row < plane_maps.height; ++row) {
            for (std::size_t column = 0; column < 22; ++column) { // five and a half pixels
                maps.object(1, row, column) = 1;
            }
        }
        pixel_correspondence const map(to_uv_view(maps), plane_image);
        std::size_t pairs = 0;
        for (std::uint32_t p = 0; p < map.grid().size(); ++p) {
            auto const q = corresponding_token(map, {1}, {0}, {p});
            CHECK(q.has_value() == (p % 16 > 5));
            CHECK(map.point_at({1}, {p}).has_value() == (p % 16 != 5)); // a silhouette shows no point
            pairs += q ? 1U : 0U;
        }
        CHECK(pairs == 8 * 10);
    }

    TEST_CASE("[GR sec. 4] a seam of the texture joins nothing") {
        // u leaps from 1 to 0 in the middle of the frame and the texture moves by half of the frame: a slope measured
        // across the leap would make distant points neighbours.
        uv_maps maps(2, {16, 64});
        maps.coverage.fill(1);
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t row = 0; row < 16; ++row) {
                for (std::size_t column = 0; column < 64; ++column) {
                    auto const u = (static_cast<double>(column) + 0.5 + 30 + static_cast<double>(i) * 16) / 64;
                    maps.uv(i, row, column, 0) = static_cast<float>(u - std::floor(u));
                    maps.uv(i, row, column, 1) = (static_cast<float>(row) + 0.5F) / 64;
                }
            }
        }
        pixel_correspondence const map(to_uv_view(maps), {4, 16});
        for (std::uint32_t p = 0; p < map.grid().size(); ++p) {
            auto const q = corresponding_token(map, {0}, {1}, {p});
            REQUIRE(q.has_value());
            CHECK(q->value == p / 16 * 16 + (p % 16 + 4) % 16);
        }
    }

    TEST_CASE("[GR sec. 4] a surface that comes nearer corresponds where pixels still meet") {
        // Twice as large in frame 1: a pixel of frame 0 is four of frame 1, whose middles lie half a pixel of frame 1
        // from its own.
        uv_maps maps(2, {32, 32});
        maps.coverage.fill(1);
        for (std::size_t i = 0; i < 2; ++i) {
            auto const step = i == 0 ? 1.0 / 64 : 0.5 / 64;
            for (std::size_t row = 0; row < 32; ++row) {
                for (std::size_t column = 0; column < 32; ++column) {
                    maps.uv(i, row, column, 0) = static_cast<float>(0.1 + static_cast<double>(column) * step);
                    maps.uv(i, row, column, 1) = static_cast<float>(0.1 + static_cast<double>(row) * step);
                }
            }
        }
        pixel_correspondence const map(to_uv_view(maps), {32, 32});
        CHECK(corresponding_token(map, {0}, {1}, {0}) == token_index{0});
        CHECK(corresponding_token(map, {0}, {1}, {4}) == token_index{2});
        CHECK_FALSE(corresponding_token(map, {0}, {1}, {5}).has_value());
    }

    TEST_CASE("pixels without a direction on the texture and pixels as large as it show no point") {
        uv_maps maps(1, {4, 4});
        maps.coverage.fill(1);
        maps.uv.fill(0.5F); // one point everywhere
        pixel_correspondence const flat(to_uv_view(maps), {4, 4});
        for (std::size_t row = 0; row < 4; ++row) {
            for (std::size_t column = 0; column < 4; ++column) {
                maps.uv(0, row, column, 0) = 0.3F * static_cast<float>(column);
                maps.uv(0, row, column, 1) = 0.3F * static_cast<float>(row);
            }
        }
        pixel_correspondence const coarse(to_uv_view(maps), {4, 4});
        // A surface one map pixel wide has no neighbour to measure along.
        maps.coverage.fill(0);
        maps.coverage(0, 1, 1) = maps.coverage(0, 2, 1) = 1;
        pixel_correspondence const thin(to_uv_view(maps), {4, 4});
        for (std::uint32_t p = 0; p < 16; ++p) {
            CHECK_FALSE(flat.point_at({0}, {p}).has_value());
            CHECK_FALSE(coarse.point_at({0}, {p}).has_value());
            CHECK_FALSE(thin.point_at({0}, {p}).has_value());
        }
    }

    TEST_CASE("threads find what one finds") {
        auto const maps = random_scene(1, 4, {48, 48}, 3);
        pixel_correspondence const alone(to_uv_view(maps), {12, 12});
        pixel_correspondence const together(to_uv_view(maps), {12, 12}, 0.25, threaded_loop{3});
        for (std::uint32_t i = 1; i < 4; ++i) {
            for (std::uint32_t p = 0; p < 144; ++p) {
                CHECK(corresponding_token(alone, {0}, {i}, {p}) == corresponding_token(together, {0}, {i}, {p}));
            }
        }
    }

    TEST_CASE("what cannot be is refused with a sentence") {
        auto maps = sliding_plane({0});
        CHECK_THROWS_WITH_AS(pixel_correspondence(to_uv_view(maps), plane_image, 0.75),
                             "pixel_correspondence: reach is 0.750000, expected a number in (0, 0.5]", value_error);
        CHECK_THROWS_WITH_AS(pixel_correspondence(to_uv_view(maps), {5, 16}),
                             "pixel_objects: grid is [5, 16], expected extents that divide the maps' [32, 64]",
                             value_error);
        maps.uv(0, 1, 1, 0) = std::numeric_limits<float>::quiet_NaN();
        CHECK_THROWS_WITH_AS(pixel_correspondence(to_uv_view(maps), plane_image),
                             "pixel_correspondence: uv is nan, expected finite texture coordinates", value_error);
    }
}
