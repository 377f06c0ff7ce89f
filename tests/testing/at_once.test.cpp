// SPDX-License-Identifier: MIT
// What may run at the same time does.
#include <genrender/testing/at_once.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

TEST_SUITE("testing/at_once") {
    using genrender::testing::at_once;

    TEST_CASE("every index is run once, and short bodies run on as many threads as there are") {
        for (std::size_t const threads : {1U, 2U, 3U}) {
            std::vector<int> runs(7);
            std::set<std::thread::id> ids;
            std::mutex mutex;
            at_once(threads, 7, [&](std::size_t i) {
                std::lock_guard const lock(mutex);
                ++runs[i];
                ids.insert(std::this_thread::get_id());
            });
            CHECK(runs == std::vector<int>(7, 1));
            CHECK(ids.size() == threads);
        }
    }
    TEST_CASE("one thread goes from the last to the first, and nothing is run of nothing") {
        std::vector<std::size_t> order;
        at_once(1, 3, [&](std::size_t i) { order.push_back(i); });
        CHECK(order == std::vector<std::size_t>{2, 1, 0});
        at_once(2, 0, [&](std::size_t) { order.clear(); });
        CHECK(order.size() == 3);
    }
    TEST_CASE("an exception of a body reaches the caller") {
        CHECK_THROWS_AS(at_once(2, 2, [](std::size_t) { throw std::runtime_error("no"); }), std::runtime_error);
    }
}
