// SPDX-License-Identifier: MIT
// Functions that crash, abort, exit and spin, tried where that does no harm.
#include <examples/support/child_trial.hpp>

#include <doctest/doctest.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <stdexcept>

using namespace genrender::examples;

TEST_SUITE("examples_support/child_trial") {
    TEST_CASE("work that returns or throws does not fail and changes nothing here") {
        int value = 1;
        CHECK(!failure_in_child([&] { value = 2; }, 10));
        CHECK(value == 1);
        CHECK(!failure_in_child([] { throw std::runtime_error("met again by the caller"); }, 10));
    }

    TEST_CASE("a crash and an abort and an exit are told from each other") {
        auto const crash = failure_in_child([] { std::raise(SIGSEGV); }, 10);
        REQUIRE(crash);
        CHECK(*crash == "crashed (Segmentation fault)");
        auto const abort = failure_in_child([] { std::abort(); }, 10);
        REQUIRE(abort);
        CHECK(*abort == "crashed (Aborted)");
        auto const exit = failure_in_child([] { std::_Exit(3); }, 10);
        REQUIRE(exit);
        CHECK(*exit == "ended with status 3");
    }

    TEST_CASE("work that never ends is stopped after its processor time") {
        auto const endless = failure_in_child(
            [] {
                for (int volatile i = 0;; i = i + 1) {
                }
            },
            1);
        REQUIRE(endless);
        CHECK(*endless == "takes more than 1 s");
    }
}
