// SPDX-License-Identifier: MIT
// Means and standard errors by hand.
#include <genrender/evaluation/mean_and_error.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

using namespace genrender;

TEST_SUITE("evaluation/mean_and_error") {
    TEST_CASE("four values by hand") {
        // Mean 5, squares 9 + 1 + 1 + 9 = 20, variance 20 / 3, error sqrt(20 / 3 / 4).
        auto const found = mean_and_error_of(std::array{2.0, 4.0, 6.0, 8.0});
        CHECK(found.mean == doctest::Approx(5));
        CHECK(*found.error == doctest::Approx(std::sqrt(5.0 / 3)));
        CHECK(found.count == 4);
    }

    TEST_CASE("equal values are sure and a single one says nothing of its error") {
        CHECK(*mean_and_error_of(std::array{0.5, 0.5, 0.5, 0.5}).error == 0.0);
        auto const single = mean_and_error_of(std::array{7.0});
        CHECK(single.mean == 7);
        CHECK_FALSE(single.error.has_value());
    }

    TEST_CASE("no values are refused") {
        CHECK_THROWS_WITH_AS(mean_and_error_of(std::vector<double>{}),
                             "mean_and_error_of: number of values is 0, expected at least 1", value_error);
    }
}
