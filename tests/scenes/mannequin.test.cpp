// SPDX-License-Identifier: MIT
// The figure is one valid mesh that its weights and its skeleton fit.
#include <examples/scenes/mannequin.hpp>

#include <genrender/scene/bounds.hpp>
#include <genrender/scene/uv_overlap.hpp>

#include <doctest/doctest.h>

#include <set>

TEST_SUITE("scenes/mannequin") {
    using namespace genrender;

    TEST_CASE("the figure stands on the ground and is as tall as it says") {
        auto const figure = scenes::make_mannequin();
        CHECK_NOTHROW(validate(figure.surface));
        auto const box = bounds_of(figure.surface.positions);
        CHECK(box.lower.y == 0);
        CHECK(box.upper.y == doctest::Approx(1.75).epsilon(0.02));
        CHECK(box.lower.x == doctest::Approx(-box.upper.x).epsilon(1e-4));
    }

    TEST_CASE("every vertex has weights of sum 1 and every joint moves something") {
        auto const figure = scenes::make_mannequin();
        REQUIRE(figure.weights.size() == figure.surface.positions.size());
        REQUIRE(figure.bones.joint_count() == scenes::joint_count);
        std::set<std::uint32_t> moved;
        std::size_t shared = 0;
        for (auto const& vertex : figure.weights) {
            auto sum = 0.0f;
            int joints = 0;
            for (int k = 0; k < 4; ++k) {
                REQUIRE(vertex.weights[k] >= 0);
                sum += vertex.weights[k];
                if (vertex.weights[k] > 0.5f) {
                    moved.insert(vertex.joints[k]);
                }
                joints += vertex.weights[k] > 0.1f;
            }
            REQUIRE(sum == doctest::Approx(1));
            shared += joints > 1;
        }
        CHECK(moved.size() == scenes::joint_count);
        CHECK(shared > figure.weights.size() / 50); // joints are soft
    }

    TEST_CASE("in the rest pose nothing moves") {
        auto const figure = scenes::make_mannequin();
        auto const global = global_transforms(figure.bones, figure.bones.rest);
        auto const posed = skin(figure.surface.positions, figure.weights, global, figure.bind);
        for (std::size_t i = 0; i < posed.size(); ++i) {
            REQUIRE(glm::length(posed[i] - figure.surface.positions[i]) < 1e-5f);
        }
    }

    TEST_CASE("a left joint's partner stands on the other side") {
        auto const figure = scenes::make_mannequin();
        auto const global = global_transforms(figure.bones, figure.bones.rest);
        for (auto const left :
             {scenes::upper_arm, scenes::forearm, scenes::hand, scenes::thigh, scenes::shin, scenes::foot}) {
            CHECK(global[left][3].x > 0);
            CHECK(global[left + scenes::right_side][3].x == doctest::Approx(-global[left][3].x));
            CHECK(global[left + scenes::right_side][3].y == doctest::Approx(global[left][3].y));
        }
    }
}
