// SPDX-License-Identifier: MIT
// The value in the middle.
#include <benchmarks/support/median.hpp>

#include <doctest/doctest.h>

using genrender::benchmarks::median;

TEST_SUITE("benchmarks_support/median") {
    TEST_CASE("a median is the value in the middle and of an even number the upper of both") {
        CHECK(median({7}) == 7);
        CHECK(median({3, 100, 1}) == 3);
        CHECK(median({4, 1, 3, 2}) == 3);
    }
}
