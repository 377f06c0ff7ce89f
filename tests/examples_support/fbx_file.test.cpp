// SPDX-License-Identifier: MIT
// FBX files, as text and as bytes, whose curves are made straight; assimp is asked what it reads of them.
#include <examples/support/fbx_file.hpp>

#include "fbx_tree.hpp"

#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

using namespace genrender::examples;
using genrender::tests::fbx_motion;

namespace {

constexpr std::int64_t one_second = 46186158000;

fbx_motion const easing{{0, one_second}, {0, 8}, {0x108, 0x108}, {0, 0, 0, 0, 0, 0, 0, 0}};
fbx_motion const going_straight{{0, one_second}, {0, 8}, {4, 4}, {0, 0, 0, 0, 0, 0, 0, 0}};

/// x of the triangle's keys, as assimp reads them.
std::vector<aiVectorKey> keys_of(std::string const& file) {
    Assimp::Importer importer;
    auto const* const scene = importer.ReadFileFromMemory(file.data(), file.size(), 0, "fbx");
    CHECK(std::string(importer.GetErrorString()) == "");
    REQUIRE(scene != nullptr);
    REQUIRE(scene->mNumAnimations == 1);
    REQUIRE(scene->mAnimations[0]->mNumChannels == 1);
    auto const& channel = *scene->mAnimations[0]->mChannels[0];
    return {channel.mPositionKeys, channel.mPositionKeys + channel.mNumPositionKeys};
}

void check_eases(std::string const& file) {
    CHECK(keys_of(file).size() == 2); // what assimp makes of the file itself
    auto const made = with_straight_curves(file);
    REQUIRE(made);
    auto const keys = keys_of(*made);
    CHECK(keys.size() == 65);
    for (auto const& key : keys) {
        auto const t = key.mTime / keys.back().mTime;
        CHECK(static_cast<double>(key.mValue.x) == doctest::Approx(8 * t * t * (3 - 2 * t)).epsilon(1e-3));
    }
}

} // namespace

TEST_SUITE("examples_support/fbx_file") {
    TEST_CASE("a text file eases in and out") { check_eases(easing.text()); }

    TEST_CASE("binary files of short and long words, packed and not, ease in and out") {
        for (std::uint32_t const version : {7400u, 7500u}) {
            for (bool const is_packed : {false, true}) {
                check_eases(easing.bytes(version, is_packed));
            }
        }
    }

    TEST_CASE("weights of tangents are read as the bits they are") {
        std::uint32_t const weights = 9000u | (9000u << 16);
        float bits = 0;
        std::memcpy(&bits, &weights, sizeof bits);
        fbx_motion const weighted{{0, one_second}, {0, 8}, {0x3000408, 0x408}, {0, 0, bits, 0, 0, 0, 0, 0}};
        for (auto const& file : {weighted.text(), weighted.bytes(7400, true)}) {
            auto const made = with_straight_curves(file);
            REQUIRE(made);
            auto const keys = keys_of(*made);
            // At a quarter of the Bezier curve's parameter
            CHECK(keys.at(16).mTime / keys.back().mTime == doctest::Approx(0.409375));
            CHECK(static_cast<double>(keys.at(16).mValue.x) == doctest::Approx(8 * 5 / 32.0));
        }
    }

    TEST_CASE("files of straight lines and files that are none are left alone") {
        CHECK(!with_straight_curves(going_straight.text()));
        CHECK(!with_straight_curves(going_straight.bytes(7400, true)));
        CHECK(!with_straight_curves(""));
        CHECK(!with_straight_curves("AnimationCurve: 6 {"));
        CHECK(!with_straight_curves("AnimationCurve: 6 { KeyTime: *2 { a: x } }"));
        std::filesystem::path const models("/usr/share/assimp/models/FBX");
        for (std::string const name : {"huesitos.fbx", "animation_with_skeleton.fbx", "spider.fbx"}) {
            if (std::ifstream stream(models / name, std::ios::binary); stream) {
                CHECK(!with_straight_curves(std::string{std::istreambuf_iterator<char>(stream), {}}));
            }
        }
    }

    TEST_CASE("files that are cut or changed anywhere do no harm") {
        for (auto const& whole : {easing.bytes(7500, true), easing.bytes(7400, false), easing.text()}) {
            auto changed = 0;
            for (std::size_t i = 0; i < whole.size(); i += 3) {
                with_straight_curves(whole.substr(0, i));
                auto other = whole;
                other[i] = static_cast<char>(other[i] ^ 0x55);
                changed += with_straight_curves(other).has_value();
            }
            CHECK(changed > 0);
        }
    }
}
