// SPDX-License-Identifier: MIT
// The version has one home: numbers, text and the version of the CMake project are the same.
#include <genrender/version.hpp>

#include <doctest/doctest.h>

#include <string>

TEST_SUITE("core/version") {
    TEST_CASE("the text is made of the three numbers") {
        CHECK(GENRENDER_VERSION_STRING == std::to_string(GENRENDER_VERSION_MAJOR) + "." +
                                              std::to_string(GENRENDER_VERSION_MINOR) + "." +
                                              std::to_string(GENRENDER_VERSION_PATCH));
    }

    TEST_CASE("one number compares versions, in the preprocessor too") {
        CHECK(GENRENDER_VERSION ==
              10000 * GENRENDER_VERSION_MAJOR + 100 * GENRENDER_VERSION_MINOR + GENRENDER_VERSION_PATCH);
        CHECK(GENRENDER_VERSION_MINOR < 100);
        CHECK(GENRENDER_VERSION_PATCH < 100);
#if GENRENDER_VERSION < 200
        FAIL("version.hpp came with 0.2.0");
#endif
    }

    TEST_CASE("the CMake project has the version of the header") {
        CHECK(std::string(GENRENDER_TEST_PROJECT_VERSION) == GENRENDER_VERSION_STRING);
    }
}
