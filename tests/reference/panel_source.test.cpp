// SPDX-License-Identifier: MIT
// Tests of taking panels from a store.
#include <genrender/reference/panel_source.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

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
}
