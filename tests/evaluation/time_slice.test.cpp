// SPDX-License-Identifier: MIT
// A row over time is a view of the same memory.
#include <genrender/evaluation/time_slice.hpp>

#include <genrender/core/stack.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("evaluation/time_slice") {
    TEST_CASE_TEMPLATE("every element of the row is where it was", Real, float, double) {
        stack<Real, 4> images({2, 3, 4, 5});
        auto const slice = time_slice(images.view(), 3);
        REQUIRE(slice.extents() == std::array<std::size_t, 3>{2, 3, 5});
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                for (std::size_t column = 0; column < 5; ++column) {
                    CHECK(&slice(i, c, column) == &images(i, c, 3, column));
                }
            }
        }
    }

    TEST_CASE("a row that the images do not have is refused") {
        stack<float, 4> const images({2, 3, 4, 5});
        CHECK_THROWS_WITH_AS(time_slice(images.view(), 4), "time_slice: row is 4, expected a row below 4", value_error);
    }
}
