// SPDX-License-Identifier: MIT
// [GR alg. 1: F_bar^i] Plans by feature grid and frame.
#include <genrender/blending/blend_plans.hpp>

#include <doctest/doctest.h>

#include <array>
#include <utility>

using namespace genrender;

TEST_SUITE("blending/blend_plans") {
    namespace {

    blend_plan<double> plan_of_one(std::uint32_t source) {
        blend_plan<double> plan;
        plan.offsets = {0, 1};
        plan.sources = {source};
        plan.weights = {1.0};
        return plan;
    }

    /// Sites 0 and 2 share a grid, of which frames 3 and 4 have plans; site 1 has another grid, of which frame 4 has one.
    blend_plans<double> some_plans() {
        blend_plans<double> plans({{8, 8}, {4, 4}, {8, 8}});
        plans.add({8, 8}, {3}, plan_of_one(30));
        plans.add({8, 8}, {4}, plan_of_one(40));
        plans.add({4, 4}, {4}, plan_of_one(41));
        return plans;
    }

    } // namespace

    TEST_CASE("sites of one grid share a frame's plan") {
        auto const plans = some_plans();
        CHECK(plans.rows({0}, {3}).sources[0] == 30);
        CHECK(plans.rows({2}, {3}).sources.data() == plans.rows({0}, {3}).sources.data());
        CHECK(plans.rows({1}, {4}).sources[0] == 41);
    }
    TEST_CASE("rows of several frames come in their order") {
        auto const plans = some_plans();
        auto const rows = plans.rows({2}, std::array<frame_index, 2>{{{4}, {3}}});
        REQUIRE(rows.size() == 2);
        CHECK(rows[0].sources[0] == 40);
        CHECK(rows[1].sources[0] == 30);
    }
    TEST_CASE("the first plan of a grid and frame stays") {
        auto plans = some_plans();
        plans.add({4, 4}, {4}, plan_of_one(7));
        CHECK(plans.rows({1}, {4}).sources[0] == 41);
    }
    TEST_CASE("rows outlive a move of their plans") {
        auto plans = some_plans();
        auto const rows = plans.rows({1}, {4});
        auto const moved = std::move(plans);
        CHECK(rows.sources.data() == moved.rows({1}, {4}).sources.data());
    }
    TEST_CASE("a site and a frame that have none are refused by name") {
        auto const plans = some_plans();
        CHECK_THROWS_WITH_AS(plans.rows({3}, {4}), "blend_plans: site is 3, expected one of the denoiser's sites",
                             value_error);
        CHECK_THROWS_WITH_AS(plans.rows({1}, {3}),
                             "blend_plans: frame is 3, expected one with a plan for [4, 4] tokens", value_error);
        CHECK_THROWS_AS(blend_plans<float>().rows({0}, {0}), value_error);
    }
}
