// SPDX-License-Identifier: MIT
// Which target is chosen, and that it can be forced.
#include <genrender/core/vector_target.hpp>

#include "support/each_vector_target.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

#define GENRENDER_KERNELS "core/vector_target.test.inl"
#include <genrender/core/each_target.inl>

using namespace genrender;

TEST_SUITE("core/vector_target") {
    TEST_CASE("every target has a name of its own") {
        CHECK(std::string(name_of(vector_target::baseline)) == "baseline");
        CHECK(std::string(name_of(vector_target::v3)) == "v3");
        CHECK(std::string(name_of(vector_target::v4)) == "v4");
    }

    TEST_CASE("the flags' own target is available and the chosen one is") {
        auto const available = available_vector_targets();
        REQUIRE_FALSE(available.empty());
        CHECK(available.front() == own_vector_target);
        CHECK(std::is_sorted(available.begin(), available.end()));
        CHECK(std::count(available.begin(), available.end(), chosen_vector_target()) == 1);
        for (auto const target : available) {
            CHECK((target == own_vector_target || target <= detail::processor_target()));
        }
    }

    TEST_CASE("a forced target is the one that kernels have") {
        auto const before = chosen_vector_target();
        testing::at_each_vector_target([] {
            auto const target = chosen_vector_target();
            CHECK(static_cast<int>(target) == detail::forced_target.load());
            auto const bytes = GENRENDER_KERNEL(testing, register_bytes)();
            CHECK((target == vector_target::v4) == (bytes == 64));
            CHECK((target != vector_target::v3 || bytes == 32));
        });
        CHECK(chosen_vector_target() == before);
    }

    TEST_CASE("a target that is not there is refused with those that are") {
        auto const available = available_vector_targets();
        for (auto const target : {vector_target::baseline, vector_target::v3, vector_target::v4}) {
            if (std::find(available.begin(), available.end(), target) == available.end()) {
                auto const sentence =
                    std::string("force_vector_target: target is ") + name_of(target) + ", expected one of ";
                CHECK_THROWS_WITH_AS(force_vector_target(target), doctest::Contains(sentence.c_str()), value_error);
            }
        }
        CHECK(detail::forced_target.load() == detail::not_forced);
    }

    TEST_CASE("of a kernel's targets the nearest below the wanted one runs") {
        auto* const own = +[] { return 0; };
        auto* const v3 = +[] { return 1; };
        auto* const v4 = +[] { return 2; };
        CHECK(detail::of_target(vector_target::baseline, own, v3, v4)() == 0);
        CHECK(detail::of_target(vector_target::v3, own, v3, v4)() == 1);
        CHECK(detail::of_target(vector_target::v4, own, v3, v4)() == 2);
        CHECK(detail::of_target(vector_target::v4, own)() == 0);
    }
}
