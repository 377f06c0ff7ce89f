// SPDX-License-Identifier: MIT
// Findings have a name each, and some forbid the run.
#include <genrender/inspection/recommendation.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <set>
#include <string_view>

TEST_SUITE("inspection/recommendation") {
    using namespace genrender;
    using enum recommendation_kind;

    TEST_CASE("every kind has a name of its own") {
        std::set<std::string_view> names;
        for (std::size_t k = 0; k < recommendation_names.size(); ++k) {
            names.insert(recommendation{.kind = static_cast<recommendation_kind>(k)}.name());
        }
        CHECK(names.size() == recommendation_names.size());
        CHECK(recommendation{.kind = mirrored}.name() == "mirrored");
        CHECK(recommendation{.kind = maps_finer_than_needed}.name() == "maps_finer_than_needed");
    }

    TEST_CASE("what a run refuses forbids it") {
        CHECK_FALSE(recommendation{.kind = mirrored, .figure = 0.48, .object = object_index{3}}.forbids_run());
        CHECK(recommendation{.kind = grid_refused, .grid = grid_extents{7, 7}}.forbids_run());
    }
}
