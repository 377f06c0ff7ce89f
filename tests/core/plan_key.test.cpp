// SPDX-License-Identifier: MIT
// Keys of plans.
#include <genrender/core/plan_key.hpp>

#include <genrender/core/parallel.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <vector>

using namespace genrender;

TEST_SUITE("core/plan_key") {
    TEST_CASE("keys are equal where grid, frame and evaluation are") {
        plan_key const key{{4, 8}, {3}, 7};
        CHECK(key == plan_key{{4, 8}, {3}, 7});
        CHECK(key != plan_key{{8, 4}, {3}, 7});
        CHECK(key != plan_key{{4, 8}, {2}, 7});
        CHECK(key != plan_key{{4, 8}, {3}, 8});
    }
    TEST_CASE("no two evaluations have the same number, whatever thread asks") {
        std::vector<std::uint64_t> numbers(200);
        threaded_loop const loop(4);
        loop(numbers.size(), [&](std::size_t i) { numbers[i] = next_evaluation(); });
        CHECK(std::set<std::uint64_t>(numbers.begin(), numbers.end()).size() == numbers.size());
        CHECK(*std::min_element(numbers.begin(), numbers.end()) > 0);
        CHECK(next_evaluation() > *std::max_element(numbers.begin(), numbers.end()));
    }
}
