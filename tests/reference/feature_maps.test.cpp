// SPDX-License-Identifier: MIT
// Tests of stacks of feature maps.
#include <genrender/reference/feature_maps.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/feature_maps") {
    TEST_CASE_TEMPLATE("both orders of axes show the same memory", Real, float, double) {
        auto maps = random_maps<Real>(2, {3, 4}, 5, 1);
        auto const first = maps.channels_first();
        CHECK(first.extents() == std::array<std::size_t, 4>{2, 5, 3, 4});
        for (std::size_t row = 0; row < 3; ++row) {
            for (std::size_t column = 0; column < 4; ++column) {
                for (std::size_t channel = 0; channel < 5; ++channel) {
                    CHECK(&first(1, channel, row, column) == &maps[1](row * 4 + column, channel));
                }
            }
        }
    }

    TEST_CASE("channels of two maps are joined token by token") {
        stack<float, 2> a({2, 1});
        stack<float, 2> b({2, 2});
        a(0, 0) = 1;
        a(1, 0) = 2;
        b(0, 0) = 3;
        b(0, 1) = 4;
        b(1, 0) = 5;
        b(1, 1) = 6;
        stack<float, 2> out({2, 3});
        concatenate(out.view(), a, b);
        for (std::size_t e = 0; e < 6; ++e) {
            CHECK(out.data()[e] == std::array{1.0f, 3.0f, 4.0f, 2.0f, 5.0f, 6.0f}[e]);
        }
        stack<float, 2> narrow({2, 2});
        CHECK_THROWS_WITH_AS(concatenate(narrow.view(), a, b), "concatenate: out is [2, 2], expected [2, 3]",
                             shape_error);
    }

    TEST_CASE("a map is multiplied by a number") {
        stack<double, 2> a({2, 1});
        a(0, 0) = 3;
        a(1, 0) = -4;
        scale_by(a.view(), 0.5);
        CHECK(a(0, 0) == 1.5);
        CHECK(a(1, 0) == -2);
    }

    TEST_CASE("a scaled map is added") {
        stack<double, 2> a({1, 2});
        stack<double, 2> b({1, 2});
        a(0, 0) = 1;
        b(0, 0) = 3;
        b(0, 1) = 4;
        add_scaled(a.view(), b, 0.5);
        CHECK(a(0, 0) == 2.5);
        CHECK(a(0, 1) == 2);
        CHECK_THROWS_WITH_AS(add_scaled(a.view(), stack<double, 2>({2, 2})),
                             "add_scaled: from is [2, 2], expected [1, 2]", shape_error);
    }
}
