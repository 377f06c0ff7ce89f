// SPDX-License-Identifier: MIT
// A whole divided among its parts: their sum is the whole, and they are as independent as if nobody had asked for it.
#include <genrender/noise/brownian_bridge.hpp>

#include <genrender/core/random.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>

using namespace genrender;

TEST_SUITE("noise/brownian_bridge") {
    TEST_CASE("the parts weighted by the roots of their shares sum to the whole") {
        std::array<double, 3> const root_shares{std::sqrt(0.5), std::sqrt(0.3), std::sqrt(0.2)};
        std::array<double, 3> Y{0.4, -1.3, 2.2};
        bridge(0.7, root_shares, Y);
        CHECK(root_shares[0] * Y[0] + root_shares[1] * Y[1] + root_shares[2] * Y[2] == doctest::Approx(0.7));
        // By hand: 0.7 - (0.282843 - 0.712039 + 0.983870) = 0.145326 is missing.
        CHECK(Y[0] == doctest::Approx(0.4 + 0.145326 * 0.707107).epsilon(1e-5));
    }

    TEST_CASE("a single part is the whole") {
        std::array<double, 1> const root_shares{1};
        std::array<double, 1> Y{5};
        bridge(-0.25, root_shares, Y);
        CHECK(Y[0] == doctest::Approx(-0.25));
    }

    TEST_CASE("parts of a normal whole are independent and of unit variance") {
        std::array<double, 3> const root_shares{std::sqrt(0.6), std::sqrt(0.25), std::sqrt(0.15)};
        constexpr std::uint32_t draws = 40000;
        std::array<std::array<double, 3>, 3> products{};
        for (std::uint32_t n = 0; n < draws; ++n) {
            std::array<double, 3> Y{};
            for (std::uint32_t j = 0; j < 3; ++j) {
                Y[j] = normal_value(3, random_stream::test, {n, j, 0});
            }
            bridge(normal_value(3, random_stream::test, {n, 3, 0}), root_shares, Y);
            for (std::size_t a = 0; a < 3; ++a) {
                for (std::size_t b = 0; b < 3; ++b) {
                    products[a][b] += Y[a] * Y[b] / draws;
                }
            }
        }
        // Four standard errors: sqrt(2 / n) for a variance, sqrt(1 / n) for a covariance.
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t b = 0; b < 3; ++b) {
                CHECK(std::abs(products[a][b] - (a == b ? 1 : 0)) < 4 * std::sqrt((a == b ? 2.0 : 1.0) / draws));
            }
        }
    }
}
