// SPDX-License-Identifier: MIT
// Shares of nothing are 0 and of something their part.
#include <genrender/inspection/object_check.hpp>

#include <doctest/doctest.h>

TEST_SUITE("inspection/object_check") {
    using namespace genrender;

    TEST_CASE("shares are parts of a whole and 0 of nothing") {
        CHECK(share_of(1, 4) == 0.25);
        CHECK(share_of(0, 0) == 0);
        frame_check frame;
        CHECK(frame.background_share() == 0);
        frame.pixels = 8;
        frame.covered = 2;
        CHECK(frame.background_share() == 0.75);
    }
}
