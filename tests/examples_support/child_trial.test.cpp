// SPDX-License-Identifier: MIT
// Functions that crash, abort, exit and spin, tried where that does no harm.
#include <examples/support/child_trial.hpp>

#include <doctest/doctest.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <vector>

using namespace genrender::examples;

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define GENRENDER_HAS_ADDRESS_SANITIZER
#endif
#endif

namespace {

#ifdef GENRENDER_HAS_ADDRESS_SANITIZER
constexpr bool has_address_sanitizer = true;
#else
constexpr bool has_address_sanitizer = false;
#endif

} // namespace

TEST_SUITE("examples_support/child_trial") {
    TEST_CASE("work that returns or throws does not fail and changes nothing here") {
        int value = 1;
        CHECK(!failure_in_child([&] { value = 2; }));
        CHECK(value == 1);
        CHECK(!failure_in_child([] { throw std::runtime_error("met again by the caller"); }));
    }

    TEST_CASE("a crash and an abort and an exit are told from each other") {
        auto const crash = failure_in_child([] { std::raise(SIGSEGV); });
        REQUIRE(crash);
        CHECK(*crash == "crashed (Segmentation fault)");
        auto const abort = failure_in_child([] { std::abort(); });
        REQUIRE(abort);
        CHECK(*abort == "crashed (Aborted)");
        auto const exit = failure_in_child([] { std::_Exit(3); });
        REQUIRE(exit);
        CHECK(*exit == "ended with status 3");
    }

    TEST_CASE("work that never ends is stopped after its processor time") {
        auto const endless = failure_in_child(
            [] {
                for (int volatile i = 0; i == 0;) {
                }
            },
            {.processor_seconds = 1});
        REQUIRE(endless);
        CHECK(*endless == "takes more than 1 s");
    }

    TEST_CASE("work that takes ever more memory is stopped") {
        auto const insatiable = failure_in_child(
            [] {
                for (std::vector<std::vector<char>> all;;) {
                    all.emplace_back(1 << 20, 'x');
                }
            },
            {.processor_seconds = 1, .bytes = 100'000'000});
        REQUIRE(insatiable);
        // AddressSanitizer's memory ends the process in its own way, or waits for ever for memory to say so
        CHECK((
            *insatiable == "needs more than 0.1 GB of memory" ||
            (has_address_sanitizer && (*insatiable == "ended with status 1" || *insatiable == "takes more than 1 s"))));
        std::vector<char> some;
        CHECK(!failure_in_child([&] { some.assign(50'000'000, 'x'); }, {.bytes = 100'000'000}));
    }
}
