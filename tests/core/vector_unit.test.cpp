// SPDX-License-Identifier: MIT
// The name of a translation unit's flags, and what its kernels are compiled for.
#include <genrender/core/vector_unit.hpp>

#include <doctest/doctest.h>

#include <string>

#define GENRENDER_TEXT_EXPANDED(x) #x
#define GENRENDER_TEXT(x) GENRENDER_TEXT_EXPANDED(x)

TEST_SUITE("core/vector_unit") {
    TEST_CASE("the name says which vectors the flags allow") {
        std::string const name = GENRENDER_TEXT(GENRENDER_UNIT);
        CHECK(name.substr(0, 4) == "unit");
#if defined(__AVX2__)
        CHECK(name.find("_avx2") != std::string::npos);
#else
        CHECK(name.find("_avx2") == std::string::npos);
#endif
#if defined(__FMA__)
        CHECK(name.find("_fma") != std::string::npos);
#else
        CHECK(name.find("_fma") == std::string::npos);
#endif
    }

    TEST_CASE("targets below the flags are not compiled again") {
        CHECK(GENRENDER_OWN_TARGET >= 0);
        CHECK(GENRENDER_OWN_TARGET <= 2);
        if (GENRENDER_OWN_TARGET >= 1) {
            CHECK(GENRENDER_COMPILES_V3 == 0);
        }
        if (GENRENDER_OWN_TARGET == 2) {
            CHECK(GENRENDER_COMPILES_V4 == 0);
        }
        if (GENRENDER_COMPILES_V3 == 1) {
            CHECK(GENRENDER_COMPILES_V4 == 1);
        }
    }
}
