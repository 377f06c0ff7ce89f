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

    TEST_CASE("a target that some keys do not name goes straight between those that do") {
        aiMeshMorphAnim channel;
        channel.mNumKeys = 3;
        channel.mKeys = new aiMeshMorphKey[3];
        auto const set = [&](unsigned k, double time, std::initializer_list<std::pair<unsigned, double>> named) {
            channel.mKeys[k].mTime = time;
            channel.mKeys[k].mNumValuesAndWeights = static_cast<unsigned>(named.size());
            channel.mKeys[k].mValues = new unsigned[named.size()];
            channel.mKeys[k].mWeights = new double[named.size()];
            std::size_t i = 0;
            for (auto const& [target, weight] : named) {
                channel.mKeys[k].mValues[i] = target;
                channel.mKeys[k].mWeights[i++] = weight;
            }
        };
        set(0, 0, {{0, 0.0}});
        set(1, 1, {{1, 1.0}});
        set(2, 4, {{1, 0.25}, {0, 1.0}});
        auto const at_time = [&](double time) {
            std::vector<float> weights{9, 9, 0.5f};
            morph_weights_at(channel, time, weights);
            return weights;
        };
        CHECK(at_time(-1) == std::vector<float>{0, 1, 0.5f});
        CHECK(at_time(1) == std::vector<float>{0.25f, 1, 0.5f});
        CHECK(at_time(2) == std::vector<float>{0.5f, 0.75f, 0.5f});
        CHECK(at_time(9) == std::vector<float>{1, 0.25f, 0.5f});
    }

    TEST_CASE("an animation whose keys are all the same moves nothing") {
        aiAnimation animation;
        animation.mNumChannels = 1;
        animation.mChannels = new aiNodeAnim* [1] { new aiNodeAnim };
        CHECK(!moves_something(animation));
        auto& channel = *animation.mChannels[0];
        channel.mNumPositionKeys = 2;
        channel.mPositionKeys = new aiVectorKey[2]{{0, {1, 2, 3}}, {5, {1, 2, 3}}};
        CHECK(!moves_something(animation));
        channel.mPositionKeys[1].mValue.z = 4;
        CHECK(moves_something(animation));
    }

    TEST_CASE("a channel replaces the nodes that FBX's reader split its transformation over") {
        // root > a_T > a_PreRotation > a_GeometricTranslation > a > child, and what the inverse of the geometry undoes
        auto const node = [](char const* name, aiVector3D const& by, aiNode* child) {
            auto* const made = new aiNode(name);
            aiMatrix4x4::Translation(by, made->mTransformation);
            if (child != nullptr) {
                made->addChildren(1, &child);
            }
            return made;
        };
        aiScene scene;
        auto* const a = node("a", {0, 0, 0}, node("child", {0, 0, 1}, nullptr));
        auto* const geometry = node("a_$AssimpFbx$_GeometricTranslation", {0, 5, 0}, a);
        auto* const turned = node("a_$AssimpFbx$_PreRotation", {0, 0, 0}, geometry);
        aiMatrix4x4::RotationZ(std::numbers::pi_v<float> / 2, turned->mTransformation);
        scene.mRootNode = node("root", {100, 0, 0}, node("a_$AssimpFbx$_Translation", {1, 2, 3}, turned));
        model_nodes nodes(scene, glm::mat4(1));
        auto const place = [&](char const* name, double seconds) {
            return glm::vec3(nodes.to_world(seconds).at(nodes.find(aiString(name)).value())[3]);
        };
        CHECK(glm::distance(place("a", 0), {100 + 1 - 5, 2, 3}) < 1e-4f); // at rest all of them count

        aiAnimation animation;
        animation.mTicksPerSecond = 1;
        animation.mNumChannels = 1;
        animation.mChannels = new aiNodeAnim* [1] { new aiNodeAnim };
        auto& channel = *animation.mChannels[0];
        channel.mNodeName = "a";
        channel.mNumPositionKeys = 2;
        channel.mPositionKeys = new aiVectorKey[2]{{0, {1, 2, 3}}, {1, {11, 2, 3}}};
        nodes.play(std::vector<aiAnimation const*>{&animation});
        // The rotation has no keys and stays as at rest: a quarter turn takes the geometry's y to -x
        CHECK(glm::distance(place("a", 0), {100 + 1 - 5, 2, 3}) < 1e-4f);
        CHECK(glm::distance(place("a", 0.5), {100 + 6 - 5, 2, 3}) < 1e-4f);
        CHECK(glm::distance(place("child", 1), {100 + 11 - 5, 2, 4}) < 1e-4f);

        // With keys of its own the rotation is the channel's, and is not applied twice
        channel.mNumRotationKeys = 1;
        channel.mRotationKeys = new aiQuatKey[1]{{0, aiQuaternion(aiVector3D(0, 0, 1), std::numbers::pi_v<float>)}};
        nodes.play(std::vector<aiAnimation const*>{&animation});
        CHECK(glm::distance(place("a", 0), {100 + 1, 2 - 5, 3}) < 1e-4f);

        // A helper that has a channel moves, and the others stay
        channel.mNodeName = "a_$AssimpFbx$_Translation";
        channel.mNumRotationKeys = 0;
        nodes.play(std::vector<aiAnimation const*>{&animation});
        CHECK(glm::distance(place("a", 1), {100 + 11 - 5, 2, 3}) < 1e-4f);
        nodes.play({});
        CHECK(glm::distance(place("a", 1), {100 + 1 - 5, 2, 3}) < 1e-4f);
        channel.mNumRotationKeys = 1; // as allocated
    }
}
