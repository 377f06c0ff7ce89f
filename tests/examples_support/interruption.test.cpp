// SPDX-License-Identifier: MIT
// The command that a program says after Ctrl-C.
#include "examples/support/interruption.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>

using namespace genrender;

TEST_SUITE("examples_support/interruption") {
    TEST_CASE("a command is quoted for a shell, and has the option once") {
        std::array const words{"build/program", "--prompt", "a 'red' ball", "--out", "", "--size=32"};
        CHECK(examples::command_text(6, words.data(), "--resume") ==
              "build/program --prompt 'a '\\''red'\\'' ball' --out '' --size=32 --resume");
        std::array const again{"program", "--resume", "--out", "run"};
        CHECK(examples::command_text(4, again.data(), "--resume") == "program --resume --out run");
    }
    TEST_CASE("Ctrl-C is noted once it is asked for") {
        CHECK(!examples::was_interrupted());
        examples::note_interruptions();
        std::raise(SIGINT);
        CHECK(examples::was_interrupted());
        examples::detail::interruption_flag() = false;
        std::signal(SIGINT, SIG_DFL);
    }
}
