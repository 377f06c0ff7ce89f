// SPDX-License-Identifier: MIT
// Random stacks are those of their seed.
#include <genrender/testing/random_stack.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>

TEST_SUITE("testing/random_stack") {
    using namespace genrender;

    TEST_CASE_TEMPLATE("equal seeds give equal elements of N(0, 1) and others do not", Real, float, double) {
        auto const a = testing::random_stack<Real, 2>({40, 50}, 3);
        auto const again = testing::random_stack<Real, 2>({40, 50}, 3);
        auto const other = testing::random_stack<Real, 2>({40, 50}, 4);
        CHECK(std::equal(a.data(), a.data() + a.size(), again.data()));
        CHECK_FALSE(std::equal(a.data(), a.data() + a.size(), other.data()));
        double mean = 0;
        double square = 0;
        for (std::size_t e = 0; e < a.size(); ++e) {
            mean += static_cast<double>(a.data()[e]) / 2000;
            square += static_cast<double>(a.data()[e]) * static_cast<double>(a.data()[e]) / 2000;
        }
        CHECK(mean == doctest::Approx(0).epsilon(0.1));
        CHECK(square == doctest::Approx(1).epsilon(0.1));
    }
}
