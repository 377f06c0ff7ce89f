// SPDX-License-Identifier: MIT
// The box around points.
#include <genrender/scene/bounds.hpp>

#include <doctest/doctest.h>

#include <array>

TEST_SUITE("scene/bounds") {
    using namespace genrender;

    TEST_CASE("the box holds its points and touches the outermost") {
        std::array<glm::vec3, 3> const points{{{1, -2, 3}, {-1, 4, 3}, {0, 0, 7}}};
        auto const box = bounds_of(points);
        CHECK(box.lower == glm::vec3(-1, -2, 3));
        CHECK(box.upper == glm::vec3(1, 4, 7));
        CHECK(box.centre() == glm::vec3(0, 1, 5));
        CHECK(box.radius() == doctest::Approx(std::sqrt(4.0 + 36.0 + 16.0) / 2));
    }

    TEST_CASE("no points have no bounds") {
        CHECK_THROWS_WITH_AS(bounds_of({}), "bounds_of: positions is empty, expected at least one point", value_error);
    }
}
