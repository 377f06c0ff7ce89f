// SPDX-License-Identifier: MIT
// Schedules of alpha by hand.
#include <genrender/injection/alpha_schedule.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

using namespace genrender;

TEST_SUITE("injection/alpha_schedule") {
    namespace {

    std::vector<double> alphas(alpha_schedule<double> const& schedule, std::size_t steps) {
        std::vector<double> all;
        for (std::size_t step = 0; step < steps; ++step) {
            all.push_back(schedule(step, {}));
        }
        return all;
    }

    } // namespace

    TEST_CASE("schedules by hand") {
        using values = std::vector<double>;
        CHECK(alphas(constant_alpha(0.7), 3) == values{0.7, 0.7, 0.7});
        CHECK(alphas(running_alpha(1.0, 0, 5), 5) == values{1, 0.75, 0.5, 0.25, 0});
        CHECK(alphas(running_alpha(0.0, 1, 3), 3) == values{0, 0.5, 1});
        CHECK(alphas(running_alpha(0.7, 0, 1), 1) == values{0.7});
        CHECK(alphas(early_alpha(0.7, 0.5, 4), 4) == values{0.7, 0.7, 0, 0});
        CHECK(alphas(early_alpha(0.7, 0.6, 4), 4) == values{0.7, 0.7, 0.7, 0}); // step 2 begins at one half
        CHECK(alphas(early_alpha(0.7, 0, 2), 2) == values{0, 0});
        CHECK(alphas(early_alpha(0.7, 1, 2), 2) == values{0.7, 0.7});
    }
    TEST_CASE("a schedule of fine sites leaves coarse ones alone") {
        auto const schedule = alpha_at_fine_sites(constant_alpha(0.7), 64);
        attention_site site;
        site.grid = {8, 8};
        CHECK(schedule(2, site) == 0.7);
        site.grid = {8, 4};
        CHECK(schedule(2, site) == 0);
    }
    TEST_CASE("a share of steps outside 0 to 1 is refused in a sentence") {
        CHECK_THROWS_WITH_AS(early_alpha(0.7, 1.5, 4), "early_alpha: share is 1.500000, expected a share in [0, 1]",
                             value_error);
    }
}
