// SPDX-License-Identifier: MIT
// Tests of the loop over OpenMP.
#include <genrender/adapters/openmp.hpp>

#include <genrender/testing/parallel_loop_laws.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace genrender;

TEST_SUITE("adapters/openmp") {
    TEST_CASE("it keeps the laws of parallel_loop") {
        CHECK(testing::check_parallel_loop_laws(openmp_loop{}).text() == "");
        CHECK(testing::check_parallel_loop_laws(openmp_loop{1}).text() == "");
        CHECK(testing::check_parallel_loop_laws(openmp_loop{3}).text() == "");
        CHECK(testing::check_parallel_loop_laws(any_loop(openmp_loop{2})).text() == "");
    }

    TEST_CASE("indices are shared among as many threads as it is told") {
        std::vector<int> thread_of(1000, -1);
        openmp_loop{3}(thread_of.size(), [&](std::size_t i) { thread_of[i] = omp_get_thread_num(); });
        std::set<int> const threads(thread_of.begin(), thread_of.end());
        CHECK(*threads.begin() >= 0);
        CHECK(*threads.rbegin() < 3);
        openmp_loop{1}(thread_of.size(), [&](std::size_t i) { thread_of[i] = omp_get_thread_num(); });
        CHECK(std::set<int>(thread_of.begin(), thread_of.end()) == std::set<int>{0});
    }

    TEST_CASE("after an exception indices that were not begun are left out") {
        std::atomic<std::size_t> begun{0};
        auto const body = [&](std::size_t i) {
            ++begun;
            if (i == 0) {
                throw std::runtime_error("first");
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1)); // so that the others take a second in all
        };
        CHECK_THROWS_AS(openmp_loop{2}(2000, body), std::runtime_error);
        CHECK(begun < 2000);
    }
}
