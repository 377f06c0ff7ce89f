// SPDX-License-Identifier: MIT
// A handle of any engine's features gives them back to that engine alone.
#include <genrender/attention/any_features.hpp>

#include <genrender/attention/host_features.hpp>

#include <doctest/doctest.h>

#include <string>

using namespace genrender;

TEST_SUITE("attention/any_features") {
    TEST_CASE("an engine gets back the features that it gave, and copies share them") {
        auto const held = any_features::of(std::string("features"));
        auto const copy = held;
        CHECK(held.as<std::string>() == "features");
        CHECK(&held.as<std::string>() == &copy.as<std::string>());
    }
    TEST_CASE("features of another engine are refused") {
        CHECK_THROWS_WITH_AS(any_features::of(1).as<long>(),
                             "any_features: the handle holds features of another engine, expected those of the engine "
                             "that asks",
                             value_error);
        CHECK_THROWS_WITH_AS(any_features().as<int>(),
                             "any_features: the handle holds nothing, expected those of the engine that asks",
                             value_error);
    }
    TEST_CASE("features are stored in 16 bits where their engine can") {
        auto const f = host_features<float>::allocate({1, 2, 3});
        auto const kept = stored(any_features::of(f), feature_storage::bf16);
        CHECK(kept.as<host_features<float>>().storage() == feature_storage::bf16);
        CHECK(stored(any_features::of(1), feature_storage::same).as<int>() == 1);
        CHECK_THROWS_AS(stored(any_features::of(1), feature_storage::f16), value_error);
    }
}
