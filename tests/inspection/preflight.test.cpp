// SPDX-License-Identifier: MIT
// A pre-flight measures what a run will do, and of bad input says a sentence: never a crash or a silent zero.
#include <genrender/inspection/preflight.hpp>

#include <genrender/maps/uv_maps.hpp>
#include <support/slanted_maps.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace preflight_test {

using namespace genrender;

inline preflight_report flown(uv_maps const& maps, render_settings<float> const& settings = {},
                              std::vector<grid_extents> const& grids = {{8, 8}, {16, 16}}) {
    return preflight(to_uv_view(maps), grids, settings);
}

/// Settings that make frame 0 the only keyframe.
inline render_settings<float> first_frame_settings() {
    render_settings<float> settings;
    settings.keyframes.drawing = keyframe_drawing::fixed;
    settings.keyframes.frames = {{0}};
    return settings;
}

inline bool says(preflight_report const& report, recommendation_kind kind) {
    return std::any_of(report.recommendations.begin(), report.recommendations.end(),
                       [&](recommendation const& one) { return one.kind == kind; });
}

} // namespace preflight_test

TEST_SUITE("inspection/preflight") {
    using namespace genrender;
    using namespace preflight_test;
    using enum recommendation_kind;
    using testing::slanted_maps;

    TEST_CASE("sound maps need no recommendation and every grid finds its partners") {
        auto const report = flown(slanted_maps(6));
        CHECK(report.recommendations.empty());
        CHECK(report.allows_run());
        CHECK(report.map_bytes == 6 * 64 * 64 * 13);
        REQUIRE(report.grids.size() == 2);
        CHECK(report.grids[0].grid == grid_extents{16, 16}); // finest first
        CHECK(report.steps == std::vector<std::size_t>{0, 16, 33});
        CHECK(report.keyframes[1] == draw_keyframes({}, 6, 16));
        for (auto const& grid : report.grids) {
            CHECK_FALSE(grid.refusal);
            REQUIRE(grid.hit_rate());
            CHECK(*grid.hit_rate() > 0.98);
            CHECK(*grid.error() < 0.6);
            CHECK(*grid.coverage() > 0.95);
        }
    }

    TEST_CASE("threads change nothing") {
        auto const maps = slanted_maps(6);
        render_settings<double> const settings;
        auto const one = preflight(to_uv_view(maps), {{16, 16}}, settings);
        auto const many = preflight(to_uv_view(maps), {{16, 16}}, settings, threaded_loop(3));
        CHECK(one.grids[0].error_sum == many.grids[0].error_sum);
        CHECK(one.grids[0].collided == many.grids[0].collided);
    }

    TEST_CASE("coordinates that are not finite forbid the run and the others are measured") {
        auto maps = slanted_maps(6);
        maps.uv(2, 30, 30, 0) = std::numeric_limits<float>::quiet_NaN();
        maps.uv(3, 30, 30, 1) = std::numeric_limits<float>::infinity();
        auto const report = flown(maps);
        CHECK_FALSE(report.allows_run());
        REQUIRE(says(report, not_finite));
        auto const& broken = report.recommendations[0];
        CHECK(broken.kind == not_finite);
        CHECK(broken.figure == 2);
        CHECK(broken.object == object_index{0});
        CHECK(broken.frames == std::vector<frame_index>{{2}, {3}});
        CHECK(*report.grids[0].hit_rate() > 0.98);

        render_settings<float> texels;
        texels.correspondence.kind = correspondence_kind::texel_grid;
        auto const refused = flown(maps, texels);
        REQUIRE(refused.grids[0].refusal);
        CHECK(refused.grids[0].refusal->find("finite texture coordinates") != std::string::npos);

        maps.uv.fill(std::numeric_limits<float>::quiet_NaN());
        auto const all = flown(maps);
        CHECK_FALSE(all.allows_run());
        CHECK_FALSE(all.grids[0].hit_rate());
    }

    TEST_CASE("all background and no frames and no grids are said or empty") {
        auto const empty = flown(uv_maps(5, {64, 64}));
        REQUIRE(says(empty, nothing_visible));
        CHECK(empty.recommendations[0].frames.size() == 5);
        CHECK_FALSE(empty.grids[0].hit_rate());
        CHECK_FALSE(empty.grids[0].coverage());
        CHECK(says(flown(uv_maps(0, {64, 64})), no_frames));
        CHECK(says(flown(uv_maps(3, {0, 0})), no_frames));
        CHECK(flown(slanted_maps(6), {}, {}).grids.empty());
    }

    TEST_CASE("one frame is said and covers itself") {
        auto settings = first_frame_settings();
        auto const report = flown(slanted_maps(1), settings);
        CHECK(says(report, one_frame));
        CHECK(report.grids[0].coverage() == 1);
        CHECK_FALSE(report.grids[0].hit_rate());
    }

    TEST_CASE("keyframes that cannot be drawn are a sentence") {
        auto const report = flown(slanted_maps(2)); // 4 keyframes of 2 frames
        CHECK_FALSE(report.allows_run());
        REQUIRE(says(report, keyframes_refused));
        CHECK(report.recommendations[0].kind == keyframes_refused);
        CHECK(report.recommendations[0].detail == "draw_keyframes: count is 4, expected 1 to the animation's 2 frames");
        CHECK(report.steps.empty());
        CHECK_FALSE(report.grids[0].coverage());
    }

    TEST_CASE("identical frames are said and meet without error") {
        auto maps = slanted_maps(1);
        uv_maps same(4, maps.grid());
        testing::visit_slanted(maps, [&](std::size_t row, std::size_t column) {
            for (std::size_t i = 0; i < 4; ++i) {
                same.coverage(i, row, column) = 1;
                same.uv(i, row, column, 0) = maps.uv(0, row, column, 0);
                same.uv(i, row, column, 1) = maps.uv(0, row, column, 1);
            }
        });
        auto const report = flown(same);
        REQUIRE(says(report, identical_frames));
        CHECK(report.recommendations[0].frames == std::vector<frame_index>{{1}, {2}, {3}});
        CHECK(report.grids[0].hit_rate() == 1);
        CHECK(report.grids[0].collisions() == 0);
        CHECK(*report.grids[0].error() < 0.2); // a representative lies half a pixel of 4 beside the middle
    }

    TEST_CASE("frames without background are said where latent normalisation skips them") {
        auto maps = slanted_maps(4);
        for (std::size_t p = 0; p < 64 * 64; ++p) {
            maps.coverage(1, p / 64, p % 64) = 1;
        }
        auto settings = render_settings<float>::plain();
        CHECK(says(flown(maps, settings), no_background));
        settings.normalization.fallback = without_background::all_pixels;
        CHECK_FALSE(says(flown(maps, settings), no_background));
        settings.normalization.fallback = without_background::skip;
        settings.normalization.window_end = 0;
        CHECK_FALSE(says(flown(maps, settings), no_background));
        settings.normalization.window_end = 1;
        settings.normalization.enabled = false;
        CHECK_FALSE(says(flown(maps, settings), no_background));
    }

    TEST_CASE("grids that do not divide the maps are refused alone") {
        auto const report = flown(slanted_maps(6), {}, {{7, 7}, {16, 16}, {0, 0}});
        CHECK_FALSE(report.allows_run());
        CHECK_FALSE(report.grids[0].refusal);
        CHECK(report.grids[1].refusal ==
              "footprint_map: grid is [7, 7], expected extents that divide the maps' [64, 64]");
        CHECK(report.grids[2].refusal);
    }

    TEST_CASE("maps too coarse or finer than needed for the grids are said") {
        CHECK(says(flown(slanted_maps(6), {}, {{32, 32}}), maps_too_coarse));
        CHECK(says(flown(slanted_maps(6), {}, {{1, 1}}), maps_finer_than_needed));
    }

    TEST_CASE("keyframes that see little of the others are too few") {
        auto maps = slanted_maps(4);
        // Frames 1 to 3 show what lies 30 pixels further right, of which frame 0 shows less than half.
        for (std::size_t i = 1; i < 4; ++i) {
            testing::visit_slanted(maps,
                                   [&](std::size_t row, std::size_t column) { maps.uv(i, row, column, 0) += 0.35F; });
        }
        auto const report = flown(maps, first_frame_settings());
        REQUIRE(says(report, low_coverage));
        CHECK(*report.grids[0].coverage() < 0.6);
        CHECK(*report.grids[0].coverage() > 0.3);
        CHECK(*report.grids[0].hit_rate() > 0.95); // what is seen is found
    }

    TEST_CASE("a window without steps draws no keyframes") {
        render_settings<float> settings;
        settings.window_end = 0;
        auto const report = flown(slanted_maps(6), settings);
        CHECK(report.steps.empty());
        CHECK_FALSE(report.grids[0].coverage());
        CHECK(report.allows_run());
    }

    TEST_CASE("texels too small meet seldom and texels too large meet far away") {
        render_settings<float> settings;
        settings.correspondence.kind = correspondence_kind::texel_grid;
        settings.correspondence.texels.T = 4096;
        auto const fine = flown(slanted_maps(6), settings, {{16, 16}});
        CHECK(says(fine, texture_too_fine));
        settings.correspondence.texels.T = 8;
        auto const coarse = flown(slanted_maps(6), settings, {{16, 16}});
        CHECK(says(coarse, texture_too_coarse));
        CHECK(*coarse.grids[0].collisions() > 0.5);
        settings.correspondence.texels.T.reset();
        CHECK(flown(slanted_maps(6), settings, {{16, 16}}).recommendations.empty());
    }
}
