// SPDX-License-Identifier: MIT
// Identities of linear blend skinning.
#include <genrender/scene/skinning.hpp>

#include <doctest/doctest.h>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

#include <limits>

namespace {

using namespace genrender;

/// An arm along +y: root at the origin, elbow at y = 1.
skeleton two_bones() { return {{std::nullopt, 0}, {glm::mat4(1), glm::translate(glm::mat4(1), {0, 1, 0})}}; }

void check_near(glm::vec3 found, glm::vec3 expected) { CHECK(glm::length(found - expected) < 1e-5f); }

constexpr float quarter_turn = 1.57079633f;

} // namespace

TEST_SUITE("scene/skinning") {
    TEST_CASE("[LBS] in the rest pose nothing moves") {
        auto const bones = two_bones();
        std::vector<glm::vec3> const rest{{0.1f, 0.2f, 0.3f}, {-0.4f, 1.5f, 0.2f}, {0, 1, 0}};
        std::vector<joint_weights> const weights{{{0, 1, 0, 0}, {0.3f, 0.7f, 0, 0}},
                                                 {{1, 0, 0, 0}, {1, 0, 0, 0}},
                                                 {{0, 1, 1, 0}, {0.25f, 0.25f, 0.25f, 0.25f}}};
        auto const posed = skin(rest, weights, global_transforms(bones, bones.rest), inverse_bind(bones));
        REQUIRE(posed.size() == 3);
        for (std::size_t i = 0; i < 3; ++i) {
            check_near(posed[i], rest[i]);
        }
    }

    TEST_CASE("[LBS] vertices of one joint turn with it about the joint") {
        auto const bones = two_bones();
        auto local = bones.rest;
        local[1] = glm::rotate(local[1], quarter_turn, glm::vec3(0, 0, 1));
        std::vector<glm::vec3> const rest{{0, 2, 0}, {0, 2, 0}, {0, 1, 0}};
        std::vector<joint_weights> const weights{
            {{1, 0, 0, 0}, {1, 0, 0, 0}}, {{0, 0, 0, 0}, {1, 0, 0, 0}}, {{1, 0, 0, 0}, {1, 0, 0, 0}}};
        auto const posed = skin(rest, weights, global_transforms(bones, local), inverse_bind(bones));
        check_near(posed[0], {-1, 1, 0}); // the tip goes around the elbow
        check_near(posed[1], {0, 2, 0});  // what follows the root stays
        check_near(posed[2], {0, 1, 0});  // the elbow itself stays
    }

    TEST_CASE("[LBS] a turn of the root turns everything and keeps distances") {
        auto const bones = two_bones();
        auto local = bones.rest;
        auto const turn = glm::rotate(glm::mat4(1), 0.7f, glm::normalize(glm::vec3(1, 2, 3)));
        local[0] = turn;
        std::vector<glm::vec3> const rest{{0.3f, 0.2f, 0.1f}, {0.5f, 1.7f, -0.2f}};
        std::vector<joint_weights> const weights{{{0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}},
                                                 {{0, 1, 0, 0}, {0.1f, 0.9f, 0, 0}}};
        auto const posed = skin(rest, weights, global_transforms(bones, local), inverse_bind(bones));
        for (std::size_t i = 0; i < 2; ++i) {
            check_near(posed[i], glm::vec3(turn * glm::vec4(rest[i], 1)));
        }
    }

    TEST_CASE("[LBS] a vertex of two joints goes to the weighted mean of where both would take it") {
        auto const bones = two_bones();
        auto local = bones.rest;
        local[1] = glm::rotate(local[1], quarter_turn, glm::vec3(0, 0, 1));
        std::vector<glm::vec3> const rest{{0, 2, 0}};
        std::vector<joint_weights> const weights{{{0, 1, 0, 0}, {0.25f, 0.75f, 0, 0}}};
        auto const posed = skin(rest, weights, global_transforms(bones, local), inverse_bind(bones));
        check_near(posed[0], 0.25f * glm::vec3(0, 2, 0) + 0.75f * glm::vec3(-1, 1, 0));
    }

    TEST_CASE("children follow their parents") {
        skeleton const chain{{std::nullopt, 0, 1}, std::vector<glm::mat4>(3, glm::translate(glm::mat4(1), {0, 1, 0}))};
        auto local = chain.rest;
        local[0] = glm::rotate(local[0], quarter_turn, glm::vec3(0, 0, 1));
        auto const global = global_transforms(chain, local);
        check_near(glm::vec3(global[2][3]), {-2, 1, 0});
    }

    TEST_CASE("weights are divided by their sum") {
        auto const even = normalized({{{0, 1, 2, 3}, {1, 1, 2, 0}}});
        CHECK(even[0].weights == glm::vec4(0.25f, 0.25f, 0.5f, 0));
        CHECK(even[0].joints == glm::uvec4(0, 1, 2, 3));
        CHECK_THROWS_WITH_AS(normalized({{{}, {1, 0, 0, 0}}, {}}),
                             "normalized: sum of weights[1] is 0.000000, expected above 0", value_error);
        CHECK_THROWS_WITH_AS(normalized({{{}, {1, -1, 1, 0}}}),
                             "normalized: weights[0] is -1.000000, expected finite weights of at least 0", value_error);
        auto const infinity = std::numeric_limits<float>::infinity();
        CHECK_THROWS_AS(normalized({{{}, {infinity, 0, 0, 0}}}), value_error);
    }

    TEST_CASE("what does not fit together is refused by name") {
        auto const bones = two_bones();
        auto const bind = inverse_bind(bones);
        std::vector<glm::vec3> const rest{{0, 0, 0}};
        std::vector<joint_weights> weights{{{0, 0, 0, 0}, {1, 0, 0, 0}}};
        CHECK_THROWS_WITH_AS(skin(rest, {}, bones.rest, bind), "skin: weights is [0], expected [1]", shape_error);
        CHECK_THROWS_WITH_AS(skin(rest, weights, std::span(bones.rest).first(1), bind),
                             "skin: bind is [2], expected [1]", shape_error);
        weights[0].weights = {0.5f, 0, 0, 0};
        CHECK_THROWS_WITH_AS(skin(rest, weights, bones.rest, bind), "skin: sum of weights[0] is 0.500000, expected 1",
                             value_error);
        weights[0] = {{0, 2, 0, 0}, {1, 0, 0, 0}};
        CHECK_THROWS_WITH_AS(skin(rest, weights, bones.rest, bind),
                             "skin: weights[0].joints is 2, expected joints below 2", value_error);
        CHECK_THROWS_WITH_AS(global_transforms(bones, bind.size() > 1 ? std::span(bind).first(1) : bind),
                             "global_transforms: local is [1], expected [2]", shape_error);
        skeleton const backwards{{1, std::nullopt}, bones.rest};
        CHECK_THROWS_WITH_AS(inverse_bind(backwards), "global_transforms: parents[0] is 1, expected a joint before it",
                             value_error);
    }
}
