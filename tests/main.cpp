// SPDX-License-Identifier: MIT
// The main function of every test executable.
#include <genrender/core/vector_target.hpp>

#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>

int main(int argc, char** argv) {
    // What GENRENDER_VECTOR_TARGET asks for may be more than this processor has: then ctest calls the test skipped.
    constexpr int skipped = 77;
    try {
        genrender::chosen_vector_target();
    } catch (genrender::value_error const& error) {
        std::puts(error.what());
        return skipped;
    }
    return doctest::Context(argc, argv).run();
}
