// SPDX-License-Identifier: MIT
// The value in the middle and what lies around it.
#include <benchmarks/support/median.hpp>

#include <doctest/doctest.h>

using genrender::benchmarks::median;
using genrender::benchmarks::median_deviation;

TEST_SUITE("benchmarks_support/median") {
    TEST_CASE("a median is the value in the middle and of an even number the upper of both") {
        CHECK(median({7}) == 7);
        CHECK(median({3, 100, 1}) == 3);
        CHECK(median({4, 1, 3, 2}) == 3);
    }

    TEST_CASE("half of the values lie within their deviation and one that is far off does not move it") {
        CHECK(median_deviation({7}) == 0);
        CHECK(median_deviation({10, 11, 13}) == 1);
        CHECK(median_deviation({10, 11, 13, 14, 1000}) == 2);
    }
}
