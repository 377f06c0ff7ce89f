// SPDX-License-Identifier: MIT
// One engine's source is C11 and C++11, and what it is called with means the same in both.
#include <genrender/c/engine.h>

#include <doctest/doctest.h>

#include <cstring>
#include <type_traits>

extern "C" genrender_engine const* engine_of_c11();
extern "C" genrender_engine const* engine_of_cxx11();

TEST_SUITE("c/engine") {
    TEST_CASE("a table that was compiled as C11 and one as C++11 read the same here") {
        auto const* const c = engine_of_c11();
        auto const* const cxx = engine_of_cxx11();
        CHECK(c != cxx);
        for (auto const* const engine : {c, cxx}) {
            CHECK(engine->version == GENRENDER_ENGINE_VERSION);
            CHECK(engine->latent_channels == 3);
            CHECK(engine->latent_grid.height == 16);
            REQUIRE(engine->site_count == 1);
            CHECK(std::strcmp(engine->sites[0].name, "decoder.attn1") == 0);
            CHECK(engine->sites[0].part == GENRENDER_PART_DECODER);
            CHECK(engine->branches == 2);
            CHECK(engine->sigma_max == 10);
            CHECK((engine->denoise != nullptr));
            CHECK((engine->mix != nullptr));
        }
    }
    TEST_CASE("a library's function is called as its type says") {
        CHECK(std::is_same_v<decltype(&engine_of_c11), genrender_engine_function>);
        CHECK(std::strcmp(GENRENDER_ENGINE_FUNCTION, "genrender_engine_of") == 0);
    }
}
