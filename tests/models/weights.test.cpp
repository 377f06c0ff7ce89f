// SPDX-License-Identifier: MIT
// Tests of the store of parameters.
#include <genrender/models/weights.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;
using testing::temporary_file;

TEST_SUITE("models/weights") {
    TEST_CASE_TEMPLATE("seeded tensors do not depend on the order of taking", Real, float, double) {
        auto first = weights<Real>::seeded(4, "unet");
        auto second = weights<Real>::seeded(4, "unet");
        auto const a = first.take("a.weight", {3, 2});
        auto const b = first.take("b.weight", {3, 2});
        CHECK(second.take("b.weight", {3, 2}) == b);
        CHECK(second.take("a.weight", {3, 2}) == a);
        CHECK(a != b);
        CHECK(first.parameter_count() == 12);
        CHECK(first.taken().at("a.weight") == std::vector<std::size_t>{3, 2});
        CHECK_NOTHROW(first.require_all_taken());
    }

    TEST_CASE_TEMPLATE("a saved store gives equal tensors", Real, float, double) {
        temporary_file const file("store.safetensors");
        auto seeded = weights<Real>::seeded(4, "unet");
        auto const a = seeded.take("a.weight", {3, 2, 3, 3});
        auto const bias = seeded.take("a.bias", {3});
        seeded.save(file.path());
        auto loaded = weights<Real>::from_file(file.path());
        CHECK(loaded.take("a.weight", {3, 2, 3, 3}) == a);
        CHECK(loaded.take("a.bias", {3}) == bias);
        CHECK_NOTHROW(loaded.require_all_taken());
    }

    TEST_CASE("a missing or misshapen tensor is named and so are those left over") {
        temporary_file const file("errors.safetensors");
        std::vector<float> const one{1.0f};
        write_safetensors(file.path(), {{"x.a", {{1}, one}}, {"x.b", {{1, 1}, one}}, {"y.c", {{1}, one}}});
        auto const text = [&](std::string const& sentence) { return file.path() + ": " + sentence; };
        auto store = weights<float>::from_file(file.path());
        CHECK_THROWS_WITH_AS(store.take("x.c", {1, 2}),
                             text("there is no tensor x.c, expected one of shape [1, 2]").c_str(), file_error);
        CHECK_THROWS_WITH_AS(store.take("x.b", {1}), text("tensor x.b is [1, 1], expected [1]").c_str(), file_error);
        CHECK_THROWS_WITH_AS(store.require_all_taken(),
                             text("2 tensors have no place in the network: x.a, y.c, expected none").c_str(),
                             file_error);
        auto part = weights<float>::from_file(file.path(), "x.");
        CHECK(part.take("a", {1}) == one);
        CHECK_THROWS_WITH_AS(part.require_all_taken(),
                             text("1 tensors have no place in the network: x.b, expected none").c_str(), file_error);
    }
}
