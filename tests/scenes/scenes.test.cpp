// SPDX-License-Identifier: MIT
// Every built-in scene fills the picture, leaves some sky, and gives any frame at any time.
#include <examples/scenes/scenes.hpp>

#include <genrender/scene/rasterizer.hpp>
#include <genrender/maps/uv_report.hpp>
#include <genrender/scene/uv_overlap.hpp>

#include <doctest/doctest.h>

#include <genrender/testing/animation_laws.hpp>

#include <string>

namespace {

using namespace genrender;

static_assert(animation<scenes::any_animation>);
static_assert(animation<scenes::camera_rotation>);
static_assert(animation<scenes::bouncing_balls>);
static_assert(animation<scenes::walking_figure>);

} // namespace

TEST_SUITE("scenes/scenes") {
    TEST_CASE("built-in scenes fulfil the laws of an animation") {
        for (auto const name : scenes::names) {
            CAPTURE(std::string(name));
            auto const scene = scenes::make_scene(name, 7);
            CHECK(scene.frame_count() == 7);
            CHECK(testing::check_animation_laws(scene).text() == "");
        }
    }

    TEST_CASE("a scene made twice is the same scene") {
        for (auto const name : scenes::names) {
            CAPTURE(std::string(name));
            auto const first = scenes::make_scene(name, 5), second = scenes::make_scene(name, 5);
            for (std::uint32_t i = 0; i < 5; ++i) {
                CHECK(testing::is_same_scene(first.frame({i}), second.frame({i})));
            }
        }
    }

    TEST_CASE("every frame shows objects on most of its pixels and some sky above them") {
        for (auto const name : scenes::names) {
            CAPTURE(std::string(name));
            auto const guidance = rasterize(scenes::make_scene(name, 12), {48, 48}, threaded_loop(2));
            auto const report = inspect(to_uv_view(guidance.uv));
            CHECK(report.all_on_texture());
            for (std::size_t i = 0; i < 12; ++i) {
                std::size_t background = 0;
                for (std::size_t row = 0; row < 48; ++row) {
                    for (std::size_t column = 0; column < 48; ++column) {
                        background += guidance.uv.coverage(i, row, column) == 0;
                    }
                }
                CHECK(background > 48 * 48 / 10);
                CHECK(background < 48 * 48 * 4 / 10);
                // Sky in the top corner, ground along the bottom.
                CHECK(guidance.uv.coverage(i, 0, 0) == 0);
                CHECK(guidance.uv.coverage(i, 47, 0) == 1);
                CHECK(guidance.uv.coverage(i, 47, 47) == 1);
            }
        }
    }

    TEST_CASE("no two places of an object share a texel") {
        for (auto const name : scenes::names) {
            CAPTURE(std::string(name));
            for (auto const& posed : scenes::make_scene(name, 1).frame({0}).objects) {
                CAPTURE(posed.object.value);
                CHECK(count_uv_overlap(*posed.surface, 256).overlapping == 0);
            }
        }
    }

    TEST_CASE("an unknown name and no frames are refused by name") {
        CHECK_THROWS_WITH_AS(scenes::make_scene("attic", 4),
                             "make_scene: name is attic, expected camera_rotation, bouncing_balls or walking_figure",
                             value_error);
        CHECK_THROWS_WITH_AS(scenes::make_scene("camera_rotation", 0),
                             "make_scene: frame_count is 0, expected at least 1", value_error);
    }
}
