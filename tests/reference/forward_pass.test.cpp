// SPDX-License-Identifier: MIT
// Tests of what a run hands to its layers.
#include <genrender/reference/forward_pass.hpp>

#include "small_networks.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::testing;

TEST_SUITE("reference/forward_pass") {
    TEST_CASE("every frame is visited once and results have all frames") {
        small_pass<float> const small;
        std::vector<int> visits(2);
        small.pass.each_frame([&](std::size_t i) { ++visits[i]; });
        CHECK(visits == std::vector<int>{1, 1});
        auto const maps = small.pass.maps({3, 2}, 4);
        CHECK(maps.view().extents() == std::array<std::size_t, 3>{2, 6, 4});
    }

    TEST_CASE("threads share out frames if there are some and else the tokens of the frame") {
        small_pass<float> const small;
        CHECK(small.pass.tokens().loop == nullptr);
        auto alone = small.pass;
        alone.frames = alone.frames.first(1);
        CHECK(alone.tokens().loop == &small.loop);
        for (auto const& loop : {small.pass.tokens(), alone.tokens()}) {
            std::vector<int> visits(3);
            loop(3, [&](std::size_t i) { ++visits[i]; });
            CHECK(visits == std::vector<int>{1, 1, 1});
        }
    }
}
