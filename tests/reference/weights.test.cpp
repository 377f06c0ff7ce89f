// SPDX-License-Identifier: MIT
// Tests of the store of parameters.
#include <genrender/reference/weights.hpp>

#include "small_networks.hpp"

#include <genrender/reference/safetensors_weights.hpp>

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

    TEST_CASE("a missing or misshapen tensor is named and so are those left over") {
        temporary_file const file("errors.safetensors");
        std::vector<float> const one{1.0f};
        write_safetensors(file.path(), {{"x.a", {{1}, one}}, {"x.b", {{1, 1}, one}}, {"y.c", {{1}, one}}});
        auto const text = [&](std::string const& sentence) { return file.path() + ": " + sentence; };
        auto store = read_weights<float>(file.path());
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
        auto store = read_weights<float>(file.path());
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
        CHECK_THROWS_WITH_AS(require_tensors(read_weights<float>(file.path()), network),
                             (file.path() + ": 1 tensors are missing: x.c [1, 2]; 1 tensors have another shape: x.b is "
                                            "[1, 1] where [1] is asked for; 1 tensors have no place in the network: "
                                            "y.c, expected none")
                                 .c_str(),
                             file_error);
        CHECK_NOTHROW(require_tensors(weights<float>::seeded(1, "unet"), network));
        write_safetensors(file.path(), {{"x.a", {{1}, one}}, {"x.b", {{1}, one}}});
        CHECK_NOTHROW(require_tensors(read_weights<float>(file.path()), [](weights<float>& source) {
            source.take("x.a", {1});
            source.take("x.b", {1});
        }));
    }
}
