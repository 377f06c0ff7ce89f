// SPDX-License-Identifier: MIT
// Tests of taking panels from a store.
#include <genrender/reference/panel_source.hpp>

#include "small_networks.hpp"

#include <genrender/reference/safetensors_weights.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <span>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/panel_source") {
    TEST_CASE_TEMPLATE("panels hold the elements of the tensor", Real, float, double) {
        auto source = weights<Real>::seeded(1, "test");
        auto const values = source.take("w", {5, 7});
        auto const panels =
            take_panels(source, "w", {5, 7}, 7, 5, [](std::size_t i, std::size_t o) { return o * 7 + i; });
        auto const in = random_stack<Real, 2>({11, 7}, 2);
        stack<Real, 2> out({11, 5});
        panels.multiply(out.view(), token_inputs<Real>::rows_of(in));
        check_close<Real, 2>(out.view(), plain_linear<Real>(in, values, {}, 5));
    }

    TEST_CASE("of a listing there are extents alone") {
        auto listing = weights<float>::listing(5, "file");
        auto const panels = take_panels(listing, "w", {1000000, 1000000}, 1000000, 1000000,
                                        [](std::size_t, std::size_t) { return std::size_t{0}; });
        CHECK(panels.inputs() == 1000000);
        CHECK(panels.outputs() == 1000000);
        CHECK(listing.taken().contains("w"));
    }

    TEST_CASE("tensors of 16 bits stay so if the store says it and give the same products") {
        temporary_file const path("half.safetensors");
        auto const values = random_stack<float, 1>({35}, 3);
        write_safetensors(path.path(), {{"w", {{5, 7}, std::span(values.data(), 35)}}}, safetensors_storage::f16);
        auto const panels_of_file = [&](bool keep) {
            auto source = read_weights<float>(path.path());
            source.keep_file_width(keep);
            return take_panels(source, "w", {5, 7}, 7, 5, [](std::size_t i, std::size_t o) { return o * 7 + i; });
        };
        auto const wide = panels_of_file(false);
        auto const narrow = panels_of_file(true);
        CHECK(2 * narrow.bytes() == wide.bytes());
        auto const in = random_stack<float, 2>({11, 7}, 2);
        stack<float, 2> out({11, 5});
        stack<float, 2> expected({11, 5});
        narrow.multiply(out.view(), token_inputs<float>::rows_of(in.view()));
        wide.multiply(expected.view(), token_inputs<float>::rows_of(in.view()));
        CHECK(std::equal(out.data(), out.data() + out.size(), expected.data()));
    }

    TEST_CASE("tensors of full width stay so whatever the store says") {
        temporary_file const path("full.safetensors");
        auto const values = random_stack<float, 1>({35}, 3);
        write_safetensors(path.path(), {{"w", {{5, 7}, std::span(values.data(), 35)}}});
        auto source = read_weights<float>(path.path());
        source.keep_file_width();
        CHECK(source.storage_of("w") == weight_storage::real);
        CHECK(source.storage_of("none") == weight_storage::real);
    }
}
