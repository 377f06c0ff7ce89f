// SPDX-License-Identifier: MIT
// [EDM alg. 1] Heun's method.
#include <genrender/sampling/heun.hpp>

#include <doctest/doctest.h>

#include <vector>

using namespace genrender;

TEST_SUITE("sampling/heun") {
    TEST_CASE("[EDM alg. 1] one step by hand") {
        // D = sigma. From 8 at level 4: d = (8 - 4) / 4 = 1, Euler's step ends at 6 at level 2, where d = (6 - 2) / 2
        // = 2. Along the mean 1.5 z falls by 3.
        auto const level = [](double, double sigma) { return sigma; };
        CHECK(heun(level, 8.0, std::vector{4.0, 2.0}) == 5.0);
    }

    TEST_CASE("[EDM alg. 1] a step is evaluated at both of its levels but never at 0") {
        std::vector<double> asked;
        auto const D = [&](double z, double sigma) {
            asked.push_back(sigma);
            return z / 2;
        };
        heun(D, 1.0, std::vector{3.0, 2.0, 1.0, 0.0});
        CHECK(asked == std::vector{3.0, 2.0, 2.0, 1.0, 1.0});
        asked.clear();
        heun(D, 1.0, std::vector{3.0, 2.0, 1.0});
        CHECK(asked == std::vector{3.0, 2.0, 2.0, 1.0});
    }
}
