// SPDX-License-Identifier: MIT
// A whole animation as guidance: the same on any number of threads, frame by frame or at once.
#include <genrender/scene/rasterizer.hpp>

#include <genrender/scene/primitives.hpp>

#include <doctest/doctest.h>

#include <glm/ext/matrix_transform.hpp>

#include <cmath>
#include <memory>

namespace {

using namespace genrender;

/// A ball that comes nearer over a floor.
struct approaching_ball {
    std::shared_ptr<mesh const> floor = std::make_shared<mesh const>(make_plane({8, 8}));
    std::shared_ptr<mesh const> ball = std::make_shared<mesh const>(make_sphere(0.5f, 24));
    std::size_t frame_count() const { return 5; }
    posed_scene frame(frame_index i) const {
        return {look_at({0, 1.5f, 5}, {0, 0.5f, 0}, 0.8f),
                {pose({0}, floor, glm::mat4(1)),
                 pose({1}, ball, glm::translate(glm::mat4(1), {0, 0.5f, static_cast<float>(i.value) * 0.6f - 1}))}};
    }
};

struct broken_last_frame : approaching_ball {
    posed_scene frame(frame_index i) const {
        auto scene = approaching_ball::frame(i);
        if (i.value == 4) {
            scene.objects[1].surface = nullptr;
        }
        return scene;
    }
};

bool is_same(rendered_guidance const& a, rendered_guidance const& b) {
    return a.uv.uv == b.uv.uv && a.uv.object == b.uv.object && a.uv.coverage == b.uv.coverage &&
           a.depth.depth == b.depth.depth && a.depth.coverage == b.depth.coverage;
}

} // namespace

TEST_SUITE("scene/rasterizer") {
    TEST_CASE("[GR sec. 3] one thread and two draw the same bits") {
        approaching_ball const scene;
        auto const one = rasterize(scene, {24, 32});
        CHECK(one.uv.frame_count() == 5);
        CHECK(one.uv.grid() == grid_extents{24, 32});
        CHECK(is_same(one, rasterize(scene, {24, 32}, threaded_loop(2))));
        CHECK(is_same(one, rasterize(scene, {24, 32}, threaded_loop(3))));
    }

    TEST_CASE("a frame drawn alone is the frame of the whole") {
        approaching_ball const scene;
        auto const whole = rasterize(scene, {24, 32});
        rendered_guidance alone{uv_maps(5, {24, 32}), depth_maps(5, {24, 32})};
        for (std::uint32_t i = 5; i-- > 0;) {
            rasterize_frame(frame_view(alone, {i}), scene.frame({i}));
        }
        alone.depth.coverage = alone.uv.coverage;
        CHECK(is_same(whole, alone));
    }

    TEST_CASE("depth is covered where UV is and the ball comes nearer") {
        auto const guidance = rasterize(approaching_ball{}, {32, 32});
        CHECK(guidance.depth.coverage == guidance.uv.coverage);
        float last_depth = 100;
        for (std::uint32_t i = 0; i < 5; ++i) {
            auto nearest = 100.0f;
            for (std::size_t row = 0; row < 32; ++row) {
                for (std::size_t column = 0; column < 32; ++column) {
                    if (guidance.uv.coverage(i, row, column) != 0 && guidance.uv.object(i, row, column) == 1) {
                        nearest = std::min(nearest, guidance.depth.depth(i, row, column));
                    }
                }
            }
            CHECK(nearest > 0);
            CHECK(nearest < last_depth - 0.5f);
            last_depth = nearest;
        }
    }

    TEST_CASE("rest positions lie on the mesh as it is at rest while the object moves") {
        auto const guidance = rasterize(approaching_ball{}, {32, 32}, sequential_loop{}, position_pass::on);
        CHECK(is_same(guidance, rasterize(approaching_ball{}, {32, 32})));
        auto const maps = to_position_view(guidance);
        std::size_t seen = 0;
        for (std::uint32_t i = 0; i < 5; ++i) {
            for (std::uint32_t row = 0; row < 32; ++row) {
                for (std::uint32_t column = 0; column < 32; ++column) {
                    auto const p = maps.point_at({i}, {row, column});
                    auto const length = std::hypot(p[0], p[1], p[2]);
                    if (!maps.is_covered({i}, {row, column})) {
                        CHECK(length == 0);
                    } else if (maps.object_at({i}, {row, column}) == object_index{1}) {
                        // The faces of the ball lie a little inside of it.
                        CHECK(length == doctest::Approx(0.5).epsilon(0.02));
                        ++seen;
                    }
                }
            }
        }
        CHECK(seen > 200);
        CHECK_THROWS_AS(to_position_view(rasterize(approaching_ball{}, {4, 4})), shape_error);
    }

    TEST_CASE("an image without pixels and a frame that does not exist are refused by name") {
        CHECK_THROWS_WITH_AS(rasterize(approaching_ball{}, {0, 4}),
                             "rasterize: grid is [0, 4], expected at least one pixel", value_error);
        auto guidance = rasterize(approaching_ball{}, {2, 2});
        CHECK_THROWS_WITH_AS(frame_view(guidance, {5}), "frame_view: i is 5, expected a frame of the guidance",
                             value_error);
    }

    TEST_CASE("what is wrong with a frame reaches the caller from any thread") {
        CHECK_THROWS_WITH_AS(rasterize(broken_last_frame{}, {4, 4}, threaded_loop(2)),
                             "rasterize: object 1 surface is null, expected a mesh", value_error);
    }
}
