// SPDX-License-Identifier: MIT
// [EDM alg. 1] Euler's method.
#include <genrender/sampling/euler.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;

TEST_SUITE("sampling/euler") {
    TEST_CASE("[EDM alg. 1] one step by hand") {
        // d = (5 - 1) / 4 = 1, so z falls by 4 - 3 = 1.
        CHECK(euler_step(5.0, 1.0, 4.0, 3.0) == 4.0);
        // Two steps towards a clean estimate of 0 from 8 at level 4: 8, 4, 2.
        auto const nothing = [](double, double) { return 0.0; };
        CHECK(euler(nothing, 8.0, std::vector{4.0, 2.0, 1.0}) == 2.0);
    }
}
