// SPDX-License-Identifier: MIT
// Keys of a node's animation and what holds before and after them.
#include <examples/support/model_nodes.hpp>

#include <doctest/doctest.h>

#include <numbers>

using namespace genrender::examples;

namespace {

std::vector<aiVectorKey> const keys{{1, {0, 0, 0}}, {2, {10, 0, 0}}, {4, {30, 4, 0}}};

double at(double time, aiAnimBehaviour before, aiAnimBehaviour after) {
    auto const interval = interval_at(std::span(keys), time, before, after);
    return keys[interval.first].mValue.x * (1 - interval.factor) + keys[interval.second].mValue.x * interval.factor;
}

} // namespace

TEST_SUITE("examples_support/model_nodes") {
    TEST_CASE("between keys values go straight") {
        CHECK(at(1, aiAnimBehaviour_DEFAULT, aiAnimBehaviour_DEFAULT) == doctest::Approx(0));
        CHECK(at(1.25, aiAnimBehaviour_DEFAULT, aiAnimBehaviour_DEFAULT) == doctest::Approx(2.5));
        CHECK(at(2, aiAnimBehaviour_DEFAULT, aiAnimBehaviour_DEFAULT) == doctest::Approx(10));
        CHECK(at(3, aiAnimBehaviour_DEFAULT, aiAnimBehaviour_DEFAULT) == doctest::Approx(20));
        CHECK(at(4, aiAnimBehaviour_DEFAULT, aiAnimBehaviour_DEFAULT) == doctest::Approx(30));
    }

    TEST_CASE("beyond the keys they hold or go on or repeat as the channel says") {
        for (auto const holding : {aiAnimBehaviour_DEFAULT, aiAnimBehaviour_CONSTANT}) {
            CHECK(at(-3, holding, aiAnimBehaviour_LINEAR) == doctest::Approx(0));
            CHECK(at(9, aiAnimBehaviour_LINEAR, holding) == doctest::Approx(30));
        }
        CHECK(at(0, aiAnimBehaviour_LINEAR, aiAnimBehaviour_DEFAULT) == doctest::Approx(-10));
        CHECK(at(6, aiAnimBehaviour_DEFAULT, aiAnimBehaviour_LINEAR) == doctest::Approx(50));
        CHECK(at(4.5, aiAnimBehaviour_DEFAULT, aiAnimBehaviour_REPEAT) == doctest::Approx(5));
        CHECK(at(0, aiAnimBehaviour_REPEAT, aiAnimBehaviour_DEFAULT) == doctest::Approx(20));
    }

    TEST_CASE("one key holds for ever") {
        auto const only = std::span(keys).first(1);
        for (auto const rule : {aiAnimBehaviour_DEFAULT, aiAnimBehaviour_LINEAR, aiAnimBehaviour_REPEAT}) {
            for (double const time : {-1.0, 1.0, 7.0}) {
                auto const interval = interval_at(only, time, rule, rule);
                CHECK(interval.first == 0);
                CHECK(interval.second == 0);
                CHECK(interval.factor == 0);
            }
        }
    }

    TEST_CASE("rotations take the short way at even speed and parts without keys stay at rest") {
        aiNodeAnim channel;
        auto const quarter = std::numbers::pi_v<float> / 2;
        // The second quaternion has the opposite sign: the same rotation, the long way for a naive blend
        aiQuaternion const end(aiVector3D(0, 0, 1), quarter);
        channel.mNumRotationKeys = 2;
        channel.mRotationKeys =
            new aiQuatKey[2]{{0, aiQuaternion()}, {3, aiQuaternion(-end.w, -end.x, -end.y, -end.z)}};
        aiMatrix4x4 rest;
        aiMatrix4x4::Translation({7, 8, 9}, rest);
        for (double const time : {0.0, 1.0, 2.0, 3.0}) {
            auto const p = transform_at(channel, rest, time) * glm::vec4(1, 0, 0, 1);
            auto const angle = static_cast<float>(time) / 3 * quarter;
            CHECK(p.x == doctest::Approx(7 + std::cos(angle)));
            CHECK(p.y == doctest::Approx(8 + std::sin(angle)));
            CHECK(p.z == doctest::Approx(9));
        }
    }

    TEST_CASE("scale comes before rotation and rotation before translation") {
        aiNodeAnim channel;
        channel.mNumPositionKeys = channel.mNumScalingKeys = channel.mNumRotationKeys = 1;
        channel.mPositionKeys = new aiVectorKey[1]{{0, {1, 2, 3}}};
        channel.mScalingKeys = new aiVectorKey[1]{{0, {10, 100, 1000}}};
        channel.mRotationKeys = new aiQuatKey[1]{{0, aiQuaternion(aiVector3D(0, 0, 1), std::numbers::pi_v<float> / 2)}};
        auto const p = transform_at(channel, {}, 0) * glm::vec4(1, 1, 1, 1);
        CHECK(p.x == doctest::Approx(1 - 100));
        CHECK(p.y == doctest::Approx(2 + 10));
        CHECK(p.z == doctest::Approx(3 + 1000));
    }

    TEST_CASE("morph weights are blended between keys target by target") {
        aiMeshMorphAnim channel;
        channel.mNumKeys = 2;
        channel.mKeys = new aiMeshMorphKey[2];
        for (unsigned k = 0; k < 2; ++k) {
            channel.mKeys[k].mTime = k;
            channel.mKeys[k].mNumValuesAndWeights = 2;
            channel.mKeys[k].mValues = new unsigned[2]{2, 99};
            channel.mKeys[k].mWeights = new double[2]{k == 0 ? 0.5 : 1.0, 1.0};
        }
        std::vector<float> weights{0.1f, 0.2f, 0.3f};
        morph_weights_at(channel, 0.5, weights);
        CHECK(weights == std::vector<float>{0.1f, 0.2f, 0.75f});
    }
}
