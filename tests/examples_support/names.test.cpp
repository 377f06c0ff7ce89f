// SPDX-License-Identifier: MIT
// Names and values, both ways.
#include <examples/support/names.hpp>

#include <doctest/doctest.h>

#include <set>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

TEST_SUITE("examples_support/names") {
    namespace {

    /// Every name leads to its value and back, and no two are alike.
    template <class Names>
    bool lead_both_ways(Names const& names) {
        std::set<std::string> all;
        for (auto const& one : names) {
            all.emplace(one.name);
            if (value_in(names, one.name) != one.value || name_in(names, one.value) != one.name) {
                return false;
            }
        }
        return all.size() == std::size(names);
    }

    } // namespace

    TEST_CASE("names and values lead to each other") {
        CHECK(lead_both_ways(method_names));
        CHECK(lead_both_ways(sampler_names));
        CHECK(lead_both_ways(noise_names));
        CHECK(lead_both_ways(storage_names));
        CHECK(value_in(sampler_names, "heun") == sampler_kind::heun);
        CHECK(all_names(noise_names) == std::vector<std::string>{"uv", "fixed", "independent"});
    }
    TEST_CASE("what has no name is refused") {
        CHECK_THROWS_WITH_AS(value_in(sampler_names, "dice"), "value_in: name is dice, expected one of the list",
                             value_error);
        CHECK_THROWS_WITH_AS(name_in(sampler_names, static_cast<sampler_kind>(9)),
                             "name_in: value is 9, expected one with a name", value_error);
    }
}
