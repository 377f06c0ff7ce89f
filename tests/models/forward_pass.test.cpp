// SPDX-License-Identifier: MIT
// Tests of what a run hands to its layers.
#include <genrender/models/forward_pass.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("models/forward_pass") {
    TEST_CASE("every frame is visited once and results begin as zeros") {
        small_pass<float> const small;
        std::vector<int> visits(2);
        small.pass.each_frame([&](std::size_t i) { ++visits[i]; });
        CHECK(visits == std::vector<int>{1, 1});
        auto const maps = small.pass.maps({3, 2}, 4);
        CHECK(maps.view().extents() == std::array<std::size_t, 3>{2, 6, 4});
        CHECK(maps[1](5, 3) == 0);
    }
}
