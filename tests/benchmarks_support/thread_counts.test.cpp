// SPDX-License-Identifier: MIT
// The numbers of threads that a kernel is timed on.
#include <benchmarks/support/thread_counts.hpp>

#include <doctest/doctest.h>

using genrender::benchmarks::thread_counts;
using counts = std::vector<std::int64_t>;

TEST_SUITE("benchmarks_support/thread_counts") {
    TEST_CASE("they are the powers of two up to the machine's number and that number itself") {
        CHECK(thread_counts(1) == counts{1});
        CHECK(thread_counts(2) == counts{1, 2});
        CHECK(thread_counts(6) == counts{1, 2, 4, 6});
        CHECK(thread_counts(8) == counts{1, 2, 4, 8});
    }
}
