// SPDX-License-Identifier: MIT
// Samples and surface points are read from maps of any type, in any order, and are those of the maps.
#include <genrender/correspondence/sample_source.hpp>

#include "../support/random_scene.hpp"

#include <genrender/maps/uv_maps_view.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>

using namespace genrender;
using genrender::testing::random_scene;

TEST_SUITE("correspondence/sample_source") {
    TEST_CASE("the point of a token is that of its representative pixel") {
        auto const maps = random_scene(5, 2, {32, 24}, 3);
        auto const view = to_uv_view(maps);
        grid_extents const grid{8, 6};
        for (auto const threads : {1U, 3U}) {
            auto const source = detail::read_samples(view, grid, 1, threaded_loop(threads));
            REQUIRE(source->frame_count() == 2);
            std::size_t shown = 0;
            for (std::uint32_t frame = 0; frame < 2; ++frame) {
                for (std::uint32_t t = 0; t < grid.size(); ++t) {
                    auto const p = representative_pixel(view, {frame}, grid, {t});
                    auto const point = source->point_at({frame}, {t});
                    REQUIRE(point.has_value() == p.has_value());
                    if (p) {
                        ++shown;
                        CHECK(point->object == view.object_at({frame}, *p));
                        CHECK(point->place == view.point_at({frame}, *p));
                        auto const samples = source->samples_in({frame});
                        REQUIRE(samples.samples_of(point->object) != nullptr);
                        CHECK(samples.samples_of(point->object)->sample_of(*point)->match.token == token_index{t});
                    }
                }
            }
            CHECK(shown > 0);
        }
    }

    TEST_CASE("coordinates that are not finite are refused as maps are read") {
        auto maps = random_scene(5, 2, {16, 16}, 1);
        maps.coverage(1, 3, 3) = 1;
        maps.uv(1, 3, 3, 0) = std::numeric_limits<float>::infinity();
        CHECK_THROWS_WITH_AS(detail::read_samples(to_uv_view(maps), {4, 4}, 1, {}),
                             "footprint_map: maps is inf, expected finite canonical coordinates", value_error);
    }
}
