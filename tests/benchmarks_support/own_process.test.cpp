// SPDX-License-Identifier: MIT
// What a copy of the process says, and that it leaves nothing behind.
#include <benchmarks/support/own_process.hpp>

#include <doctest/doctest.h>

#include <array>
#include <stdexcept>

#include <unistd.h>

using namespace genrender::benchmarks;

TEST_SUITE("benchmarks_support/own_process") {
    TEST_CASE("a value of another process comes back and nothing else does") {
        auto here = 1;
        auto const heard = in_own_process([&] {
            here = 2;
            return std::array<double, 2>{0.5, static_cast<double>(getpid())};
        });
        REQUIRE(heard.has_value());
        CHECK((*heard)[0] == 0.5);
        CHECK((*heard)[1] != static_cast<double>(getpid()));
        CHECK(here == 1);
    }

    TEST_CASE("there is no value of a process that fails") {
        CHECK_FALSE(in_own_process([]() -> int { throw std::runtime_error("no"); }).has_value());
        CHECK_FALSE(in_own_process([]() -> int { _exit(3); }).has_value());
    }
}
