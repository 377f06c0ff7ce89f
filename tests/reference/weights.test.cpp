// SPDX-License-Identifier: MIT
// Tests of the store of parameters.
#include <genrender/reference/weights.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;

using namespace genrender::reference;
using testing::temporary_file;

TEST_SUITE("reference/weights") {
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
    }

    TEST_CASE("tensors may be left over whose names begin as the network says") {
        temporary_file const file("left.safetensors");
        std::vector<float> const one{1.0f};
        write_safetensors(file.path(), {{"x.a", {{1}, one}}, {"x.b", {{1}, one}}, {"y.c", {{1}, one}}});
        auto store = weights<float>::from_file(file.path());
        CHECK(store.holds("x.a"));
        CHECK(!store.holds("x"));
        CHECK(!weights<float>::seeded(1, "").holds("x.a"));
        store.leave("x.");
        auto const text = file.path() + ": 1 tensors have no place in the network: y.c, expected none";
        CHECK_THROWS_WITH_AS(store.require_all_taken(), text.c_str(), file_error);
        store.leave("y.c");
        CHECK_NOTHROW(store.require_all_taken());
        CHECK(store.taken().empty());
    }

    TEST_CASE_TEMPLATE("the shards of a network are one store", Real, float, double) {
        temporary_file const first("first.safetensors");
        temporary_file const second("second.safetensors");
        std::vector<float> const one{1.0f};
        std::vector<float> const two{2.0f};
        write_safetensors(first.path(), {{"a", {{1}, one}}, {"c", {{1}, two}}});
        write_safetensors(second.path(), {{"b", {{1}, two}}});
        auto store = weights<Real>::from_files({first.path(), second.path()});
        CHECK(store.take("b", {1}) == std::vector<Real>{2});
        CHECK(store.take("a", {1}) == std::vector<Real>{1});
        CHECK_THROWS_WITH_AS(store.take("b", {2}), (second.path() + ": tensor b is [1], expected [2]").c_str(),
                             file_error);
        CHECK_THROWS_WITH_AS(store.take("d", {1}),
                             (first.path() + ": there is no tensor d, expected one of shape [1]").c_str(), file_error);
        CHECK_THROWS_WITH_AS(store.require_all_taken(),
                             (first.path() + ": 1 tensors have no place in the network: c, expected none").c_str(),
                             file_error);
        CHECK_THROWS_WITH_AS(weights<Real>::from_files({}), "weights: paths is empty, expected at least one",
                             value_error);
        write_safetensors(second.path(), {{"a", {{1}, two}}});
        CHECK_THROWS_WITH_AS(
            weights<Real>::from_files({first.path(), second.path()}),
            (second.path() + ": tensor a is in " + first.path() + " too, expected each tensor once").c_str(),
            file_error);
    }

    TEST_CASE("a listing is asked for no more than it should be and gives nothing") {
        auto listing = weights<float>::listing(2, "file");
        CHECK(listing.is_listing());
        CHECK(listing.take("a", {3, 1000000}).empty());
        CHECK(listing.take("b", {1}).empty());
        CHECK(listing.take("a", {3, 1000000}).empty());
        CHECK_THROWS_WITH_AS(listing.take("c", {1}),
                             "file: the config asks for more than 2 tensors, expected about as many as there are",
                             file_error);
        CHECK_NOTHROW(listing.require_all_taken());
    }

    TEST_CASE("all that is missing misshapen or left over is told at once and random tensors are as asked for") {
        temporary_file const file("errors.safetensors");
        std::vector<float> const one{1.0f};
        write_safetensors(file.path(), {{"x.a", {{1}, one}}, {"x.b", {{1, 1}, one}}, {"y.c", {{1}, one}}});
        auto const network = [](weights<float>& source) {
            source.take("x.a", {1});
            source.take("x.b", {1});
            source.take("x.c", {1, 2});
        };
        CHECK_THROWS_WITH_AS(require_tensors(weights<float>::from_file(file.path()), network),
                             (file.path() + ": 1 tensors are missing: x.c [1, 2]; 1 tensors have another shape: x.b is "
                                            "[1, 1] where [1] is asked for; 1 tensors have no place in the network: "
                                            "y.c, expected none")
                                 .c_str(),
                             file_error);
        CHECK_NOTHROW(require_tensors(weights<float>::seeded(1, "unet"), network));
        write_safetensors(file.path(), {{"x.a", {{1}, one}}, {"x.b", {{1}, one}}});
        CHECK_NOTHROW(require_tensors(weights<float>::from_file(file.path()), [](weights<float>& source) {
            source.take("x.a", {1});
            source.take("x.b", {1});
        }));
    }
}
