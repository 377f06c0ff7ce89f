// SPDX-License-Identifier: MIT
// Tests of the loop over oneTBB.
#include <genrender/adapters/tbb.hpp>

#include <genrender/testing/parallel_loop_laws.hpp>

#include <doctest/doctest.h>

#include <tbb/task_arena.h>

#include <cstddef>
#include <vector>

using namespace genrender;

TEST_SUITE("adapters/tbb") {
    TEST_CASE("it keeps the laws of parallel_loop") {
        CHECK(testing::check_parallel_loop_laws(tbb_loop{}).text() == "");
        CHECK(testing::check_parallel_loop_laws(any_loop(tbb_loop{})).text() == "");
    }

    TEST_CASE("an arena bounds its threads") {
        tbb::task_arena arena(1);
        std::vector<int> slots(1000, -1);
        arena.execute([&] {
            tbb_loop{}(slots.size(), [&](std::size_t i) { slots[i] = tbb::this_task_arena::current_thread_index(); });
        });
        for (auto const slot : slots) {
            CHECK(slot == 0);
        }
    }
}
