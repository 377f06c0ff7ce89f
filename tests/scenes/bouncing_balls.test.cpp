// SPDX-License-Identifier: MIT
// Bodies fall, bounce, stay in the picture and stay out of the ground.
#include <examples/scenes/bouncing_balls.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

namespace {

using namespace genrender;

float lowest(posed_object const& posed) {
    auto y = posed.positions.front().y;
    for (auto const& p : posed.positions) {
        y = std::min(y, p.y);
    }
    return y;
}

glm::vec3 centre(posed_object const& posed) { return bounds_of(posed.positions).centre(); }

} // namespace

TEST_SUITE("scenes/bouncing_balls") {
    TEST_CASE("no body sinks into the ground by more than a hand") {
        scenes::bouncing_balls const scene(96);
        for (std::uint32_t i = 0; i < 96; ++i) {
            auto const frame = scene.frame({i});
            for (std::size_t body = 1; body < frame.objects.size(); ++body) {
                REQUIRE(lowest(frame.objects[body]) > -0.04f);
            }
        }
    }

    TEST_CASE("the first thing every body does is fall as far as gravity takes it") {
        // 48 frames in two seconds: frame 3 is 6 / 47 s in, before anything is met by the highest ball.
        scenes::bouncing_balls const scene(48);
        auto const start = centre(scene.frame({0}).objects[3]), later = centre(scene.frame({3}).objects[3]);
        auto const time = 3 * 2.0 / 47;
        CHECK(later.y - start.y == doctest::Approx(-1.0 * time - 9.81 / 2 * time * time).epsilon(0.05));
    }

    TEST_CASE("balls bounce up again and go on moving") {
        scenes::bouncing_balls const scene(64);
        std::size_t bounced = 0;
        for (std::size_t body = 1; body <= 7; ++body) {
            auto low = centre(scene.frame({0}).objects[body]).y, rise = 0.0f;
            for (std::uint32_t i = 1; i < 64; ++i) {
                auto const y = centre(scene.frame({i}).objects[body]).y;
                low = std::min(low, y);
                rise = std::max(rise, y - low);
            }
            bounced += rise > 0.3f;
        }
        CHECK(bounced >= 5);
    }

    TEST_CASE("all bodies stay near the middle of the ground") {
        scenes::bouncing_balls const scene(120);
        for (std::uint32_t i = 0; i < 120; i += 7) {
            auto const frame = scene.frame({i});
            for (std::size_t body = 1; body < frame.objects.size(); ++body) {
                auto const place = centre(frame.objects[body]);
                REQUIRE(std::abs(place.x) < 2.3f);
                REQUIRE(std::abs(place.z) < 2.3f);
            }
        }
    }

    TEST_CASE("bodies keep their size") {
        scenes::bouncing_balls const scene(16);
        auto const frame = scene.frame({15});
        for (std::size_t body = 1; body < frame.objects.size(); ++body) {
            auto const& posed = frame.objects[body];
            auto const& rest = posed.surface->positions;
            auto const across = glm::length(rest.front() - rest.back());
            CHECK(glm::length(posed.positions.front() - posed.positions.back()) ==
                  doctest::Approx(across).epsilon(1e-4));
        }
    }

    TEST_CASE("one frame alone is the first frame of many") {
        auto const one = scenes::bouncing_balls(1).frame({0}), many = scenes::bouncing_balls(30).frame({0});
        for (std::size_t i = 0; i < one.objects.size(); ++i) {
            CHECK(one.objects[i].positions == many.objects[i].positions);
        }
    }
}
