// SPDX-License-Identifier: MIT
// [GR eq. 4] Reprojection.
#include <genrender/correspondence/reproject.hpp>

#include "../support/random_scene.hpp"
#include <genrender/testing/random_stack.hpp>
#include "../support/shifted_strip.hpp"

#include <genrender/correspondence/texel_grid.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("correspondence/reproject") {
    TEST_CASE_TEMPLATE("[GR eq. 4] features follow the surface from frame to frame", Real, float, double) {
        testing::shifted_strip const strip{2, 3};
        stack<Real, 2> F_0({3, 1});
        F_0(0, 0) = 10;
        F_0(1, 0) = 20;
        F_0(2, 0) = 30;
        stack<Real, 2> F_1({3, 1});
        F_1(2, 0) = -1;
        auto const covered = reproject(F_1.view(), F_0, strip, {0}, {1});
        CHECK(F_1(0, 0) == 20);
        CHECK(F_1(1, 0) == 30);
        CHECK(F_1(2, 0) == -1); // the strip's next point, which frame 0 does not show
        CHECK(covered == std::vector<std::uint8_t>{1, 1, 0});
    }
    TEST_CASE("[GR eq. 4] reprojecting a frame to itself changes nothing where texels are finer than tokens") {
        auto const maps = testing::random_scene(11, 2, {64, 64}, 3);
        texel_grid const map(to_uv_view(maps), {16, 16}, {.T = 4096});
        auto const F = testing::random_stack<double, 2>({256, 4}, 1);
        auto back = F;
        for (std::size_t e = 0; e < back.size(); ++e) {
            back.data()[e] = 0;
        }
        auto const covered = reproject(back.view(), F, map, {1}, {1});
        std::size_t seen = 0;
        for (std::uint32_t t = 0; t < 256; ++t) {
            CHECK(bool(covered[t]) == map.point_at({1}, {t}).has_value());
            seen += covered[t];
            for (std::size_t c = 0; c < 4 && covered[t] != 0; ++c) {
                CHECK(back(t, c) == F(t, c));
            }
        }
        CHECK(seen > 50);
    }
    TEST_CASE("features and frames that do not fit are refused by name") {
        testing::shifted_strip const strip{2, 3};
        stack<float, 2> F({3, 1});
        stack<float, 2> longer({4, 1});
        CHECK_THROWS_WITH_AS(reproject(F.view(), F, strip, {0}, {2}), "reproject: j is 2, expected a frame below 2",
                             value_error);
        CHECK_THROWS_WITH_AS(reproject(F.view(), longer, strip, {0}, {1}), "reproject: F_i is [4, 1], expected [3, 1]",
                             shape_error);
        CHECK_THROWS_WITH_AS(reproject(longer.view(), F, strip, {0}, {1}), "reproject: F_j is [4, 1], expected [3, 1]",
                             shape_error);
    }
}
