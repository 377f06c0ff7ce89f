// SPDX-License-Identifier: MIT
// Tests of weights from files and into one.
#include <genrender/reference/safetensors_weights.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using testing::temporary_file;

TEST_SUITE("reference/safetensors_weights") {
    TEST_CASE_TEMPLATE("a saved store gives equal tensors", Real, float, double) {
        temporary_file const file("store.safetensors");
        auto seeded = weights<Real>::seeded(4, "unet");
        auto const a = seeded.take("a.weight", {3, 2, 3, 3});
        auto const bias = seeded.take("a.bias", {3});
        write_weights(file.path(), seeded);
        auto loaded = read_weights<Real>(file.path());
        CHECK(loaded.take("a.weight", {3, 2, 3, 3}) == a);
        CHECK(loaded.take("a.bias", {3}) == bias);
        CHECK_NOTHROW(loaded.require_all_taken());
    }

    TEST_CASE_TEMPLATE("the shards of a network are one store", Real, float, double) {
        temporary_file const first("first.safetensors");
        temporary_file const second("second.safetensors");
        std::vector<float> const one{1.0f};
        std::vector<float> const two{2.0f};
        write_safetensors(first.path(), {{"a", {{1}, one}}, {"c", {{1}, two}}});
        write_safetensors(second.path(), {{"b", {{1}, two}}});
        auto store = read_weights<Real>({first.path(), second.path()});
        CHECK(store.take("b", {1}) == std::vector<Real>{2});
        CHECK(store.take("a", {1}) == std::vector<Real>{1});
        CHECK_THROWS_WITH_AS(store.take("b", {2}), (second.path() + ": tensor b is [1], expected [2]").c_str(),
                             file_error);
        CHECK_THROWS_WITH_AS(store.take("d", {1}),
                             (first.path() + ": there is no tensor d, expected one of shape [1]").c_str(), file_error);
        CHECK_THROWS_WITH_AS(store.require_all_taken(),
                             (first.path() + ": 1 tensors have no place in the network: c, expected none").c_str(),
                             file_error);
        CHECK_THROWS_WITH_AS(read_weights<Real>(std::vector<std::string>{}),
                             "read_weights: paths is empty, expected at least one", value_error);
        write_safetensors(second.path(), {{"a", {{1}, two}}});
        CHECK_THROWS_WITH_AS(
            read_weights<Real>({first.path(), second.path()}),
            (second.path() + ": tensor a is in " + first.path() + " too, expected each tensor once").c_str(),
            file_error);
    }
}
