// SPDX-License-Identifier: MIT
// The main function of every test executable.
#include <genrender/core/vector_target.hpp>

#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
// What assimp does not give back is not ours.
extern "C" char const* __lsan_default_suppressions();
extern "C" char const* __lsan_default_suppressions() { return "leak:libassimp"; }
#endif
#endif

int main(int argc, char** argv) {
    // GENRENDER_VECTOR_TARGET may ask for more than this processor has, or for what runs here anyway, a process a case:
    // then ctest calls the test skipped.
    constexpr int skipped = 77;
    try {
        auto const asked = genrender::chosen_vector_target();
        if (std::getenv("GENRENDER_VECTOR_TARGET") != nullptr &&
            asked == genrender::available_vector_targets().back()) {
            std::puts("The cases by themselves run at this vector target.");
            return skipped;
        }
    } catch (genrender::value_error const& error) {
        std::puts(error.what());
        return skipped;
    }
    return doctest::Context(argc, argv).run();
}
