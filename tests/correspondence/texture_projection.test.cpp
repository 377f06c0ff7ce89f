// SPDX-License-Identifier: MIT
// [GR alg. 1: pi] Projection and unprojection.
#include <genrender/correspondence/texture_projection.hpp>

#include "../support/random_scene.hpp"
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("correspondence/texture_projection") {
    TEST_CASE_TEMPLATE("a constant survives unprojection and projection", Real, float, double) {
        auto const maps = testing::random_scene(2, 2, {48, 48}, 3);
        for (auto const reading : {texel_reading::nearest_sample, texel_reading::average}) {
            texel_grid const map(to_uv_view(maps), {12, 12}, {.reading = reading});
            stack<Real, 2> F({144, 2});
            for (std::size_t e = 0; e < F.size(); ++e) {
                F.data()[e] = Real(3.5);
            }
            stack<Real, 2> T({map.slot_count(), 2});
            unproject(T.view(), F, map, {0});
            stack<Real, 2> back({144, 2});
            auto const covered = project(back.view(), T, map, {0});
            std::size_t seen = 0;
            for (std::size_t t = 0; t < 144; ++t) {
                seen += covered[t];
                CHECK(back(t, std::size_t{1}) == doctest::Approx(covered[t] != 0 ? 3.5 : 0.0));
            }
            CHECK(seen > 30);
        }
    }
    TEST_CASE("projecting what was unprojected from another frame is reprojection") {
        auto const maps = testing::random_scene(8, 2, {48, 48}, 3);
        texel_grid const map(to_uv_view(maps), {12, 12});
        auto const F = testing::random_stack<double, 2>({144, 3}, 4);
        stack<double, 2> T({map.slot_count(), 3});
        auto const filled = unproject(T.view(), F, map, {0});
        stack<double, 2> through_texture({144, 3});
        project(through_texture.view(), T, map, {1});
        stack<double, 2> direct({144, 3});
        auto const covered = reproject(direct.view(), F, map, {0}, {1});
        std::size_t compared = 0;
        for (std::uint32_t t = 0; t < 144; ++t) {
            auto const point = map.point_at({1}, {t});
            CHECK(bool(covered[t]) == (point && filled[point->slot] != 0));
            for (std::size_t c = 0; c < 3 && covered[t] != 0; ++c, ++compared) {
                CHECK(through_texture(t, c) == direct(t, c));
            }
        }
        CHECK(compared > 90);
    }
    TEST_CASE("textures that do not fit are refused by name") {
        auto const maps = testing::random_scene(2, 1, {16, 16}, 2);
        texel_grid const map(to_uv_view(maps), {4, 4});
        stack<float, 2> F({16, 1});
        stack<float, 2> T({1, 1});
        auto const expected = "[" + std::to_string(map.slot_count()) + ", 1]";
        CHECK_THROWS_WITH_AS(project(F.view(), T, map, {0}), ("project: T is [1, 1], expected " + expected).c_str(),
                             shape_error);
        CHECK_THROWS_WITH_AS(unproject(T.view(), F, map, {0}), ("unproject: T is [1, 1], expected " + expected).c_str(),
                             shape_error);
    }
}
