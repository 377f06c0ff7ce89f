// SPDX-License-Identifier: MIT
// Tests of what the reference network is told.
#include <genrender/reference/network_conditioning.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace genrender;

using namespace genrender::reference;

TEST_SUITE("reference/network_conditioning") {
    TEST_CASE_TEMPLATE("inverse depth is repeated over the channels of the hint", Real, float, double) {
        stack<float, 3> depth({2, 1, 3});
        depth(1, 0, 2) = 0.5f;
        auto const hint = depth_hint<Real>(depth, 4);
        CHECK(hint.extents() == std::array<std::size_t, 4>{2, 4, 1, 3});
        for (std::size_t channel = 0; channel < 4; ++channel) {
            CHECK(hint(1, channel, 0, 2) == Real(0.5));
            CHECK(hint(0, channel, 0, 2) == 0);
        }
        depth(0, 0, 1) = std::numeric_limits<float>::infinity();
        CHECK_THROWS_WITH_AS(depth_hint<Real>(depth), "depth_hint: inverse_depth is inf, expected finite numbers",
                             value_error);
    }
}
