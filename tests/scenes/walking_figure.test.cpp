// SPDX-License-Identifier: MIT
// The figure gets on, its feet find the ground, and its limbs swing.
#include <examples/scenes/walking_figure.hpp>

#include <genrender/scene/bounds.hpp>

#include <doctest/doctest.h>

#include <algorithm>

namespace {

using namespace genrender;

bounds figure_bounds(scenes::walking_figure const& scene, std::uint32_t frame) {
    return bounds_of(scene.frame({frame}).objects[1].positions);
}

} // namespace

TEST_SUITE("scenes/walking_figure") {
    TEST_CASE("the lowest point of the figure touches the ground in every frame") {
        scenes::walking_figure const scene(24);
        for (std::uint32_t i = 0; i < 24; ++i) {
            CHECK(figure_bounds(scene, i).lower.y == doctest::Approx(0).epsilon(1e-5));
            CHECK(figure_bounds(scene, i).upper.y > 1.6f);
        }
    }

    TEST_CASE("one cycle of 24 frames takes the figure one stride of human length") {
        scenes::walking_figure const scene(48);
        CHECK(scene.stride() > 1.1f);
        CHECK(scene.stride() < 1.7f);
        auto const first = scene.frame({0}).objects[1].positions, later = scene.frame({24}).objects[1].positions;
        for (std::size_t i = 0; i < first.size(); i += 101) {
            CHECK(later[i].z - first[i].z == doctest::Approx(scene.stride()).epsilon(1e-4));
            CHECK(later[i].x == doctest::Approx(first[i].x).epsilon(1e-4));
        }
    }

    TEST_CASE("the standing foot hardly slides") {
        // Over a short moment in mid stance the lowest vertex moves by much less than the figure.
        scenes::walking_figure const scene(96); // four cycles
        auto slid = 0.0f;
        for (std::uint32_t i = 0; i < 24; ++i) {
            auto const now = scene.frame({i}).objects[1].positions, next = scene.frame({i + 1}).objects[1].positions;
            auto const lowest =
                std::min_element(now.begin(), now.end(), [](auto const& a, auto const& b) { return a.y < b.y; });
            slid += next[static_cast<std::size_t>(lowest - now.begin())].z - lowest->z;
        }
        CHECK(std::abs(slid) < 0.2f * scene.stride());
    }

    TEST_CASE("the head bobs by centimetres and the legs open and close") {
        scenes::walking_figure const scene(24);
        auto lowest_head = 10.0f, highest_head = 0.0f, shortest = 10.0f, longest = 0.0f;
        for (std::uint32_t i = 0; i < 24; ++i) {
            auto const box = figure_bounds(scene, i);
            lowest_head = std::min(lowest_head, box.upper.y);
            highest_head = std::max(highest_head, box.upper.y);
            shortest = std::min(shortest, box.upper.z - box.lower.z);
            longest = std::max(longest, box.upper.z - box.lower.z);
        }
        CHECK(highest_head - lowest_head > 0.01f);
        CHECK(highest_head - lowest_head < 0.12f);
        CHECK(longest > shortest + 0.2f);
    }

    TEST_CASE("the camera goes along and the stones stay") {
        scenes::walking_figure const scene(24);
        auto const first = scene.frame({0}), last = scene.frame({23});
        CHECK(position_of(last.camera).z - position_of(first.camera).z > 0.8f * scene.stride());
        REQUIRE(first.objects.size() > 2);
        for (std::size_t i = 0; i < first.objects.size(); ++i) {
            CHECK((first.objects[i].positions == last.objects[i].positions) == (i != 1));
        }
    }
}
