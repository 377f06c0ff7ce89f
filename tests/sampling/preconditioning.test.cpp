// SPDX-License-Identifier: MIT
// [EDM eq. 7] From what a raw network predicts to the clean estimate.
#include <genrender/sampling/preconditioning.hpp>

#include <doctest/doctest.h>

#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

using namespace genrender;

namespace {

constexpr std::array predictions = {prediction::epsilon, prediction::velocity, prediction::clean, prediction::flow};
constexpr std::array levels = {0.0, 0.0292, 0.5, 1.0, 3.0, 14.6146};

/// Noise that depends on the draw.
template <class Real>
stack<Real, 4> normal_stack(std::uint32_t draw) {
    stack<Real, 4> values({2, 3, 2, 5});
    for (std::uint32_t i = 0; i < values.size(); ++i) {
        values.data()[i] = static_cast<Real>(normal_value(7, random_stream::test, {draw, i, 0}));
    }
    return values;
}

/// What an exact network of each kind sees and says, in the letters of its own paper.
template <class Real>
struct exact_network {
    Real input;
    Real output;
};

template <class Real>
exact_network<Real> exact(prediction predicted, Real x0, Real n, Real sigma) {
    // alpha^2 + beta^2 = 1 and beta / alpha = sigma.
    auto const angle = std::atan(sigma);
    auto const alpha = std::cos(angle);
    auto const beta = std::sin(angle);
    auto const t = flow_time_of(sigma);
    switch (predicted) {
    case prediction::epsilon:
        return {alpha * x0 + beta * n, n};
    case prediction::velocity:
        return {alpha * x0 + beta * n, alpha * n - beta * x0};
    case prediction::clean:
        return {alpha * x0 + beta * n, x0};
    case prediction::flow:
        return {(1 - t) * x0 + t * n, n - x0};
    }
    return {};
}

} // namespace

TEST_SUITE("sampling/preconditioning") {
    TEST_CASE("[EDM table 1] factors of each prediction at sigma 3/4") {
        // 1 + sigma^2 = 25 / 16, so a = 4 / 5 and b = 3 / 5; t = 3 / 7.
        auto const check = [](prediction predicted, double c_skip, double c_out, double c_in) {
            auto const factors = scalings_of(predicted, 0.75);
            CHECK(factors.c_skip == doctest::Approx(c_skip).epsilon(1e-15));
            CHECK(factors.c_out == doctest::Approx(c_out).epsilon(1e-15));
            CHECK(factors.c_in == doctest::Approx(c_in).epsilon(1e-15));
        };
        check(prediction::epsilon, 1, -0.75, 0.8);
        check(prediction::velocity, 0.64, -0.6, 0.8);
        check(prediction::clean, 0, 1, 0.8);
        check(prediction::flow, 4.0 / 7, -3.0 / 7, 4.0 / 7);
    }

    TEST_CASE_TEMPLATE("[EDM eq. 7] the clean estimate of an exact network is x0", Real, float, double) {
        auto const x0 = normal_stack<Real>(0);
        auto const n = normal_stack<Real>(1);
        for (auto const predicted : predictions) {
            for (auto const level : levels) {
                auto const sigma = static_cast<Real>(level);
                stack<Real, 4> z(x0.extents());
                stack<Real, 4> F(x0.extents());
                stack<Real, 4> found(x0.extents());
                for (std::size_t i = 0; i < x0.size(); ++i) {
                    z.data()[i] = x0.data()[i] + sigma * n.data()[i];
                    F.data()[i] = exact(predicted, x0.data()[i], n.data()[i], sigma).output;
                }
                to_clean(found.view(), predicted, z, F, sigma);
                // Roundings are relative to z, whose values stay below 5 (1 + sigma).
                auto const bound = 20 * (1 + sigma) * std::numeric_limits<Real>::epsilon();
                for (std::size_t i = 0; i < x0.size(); ++i) {
                    CHECK(std::abs(found.data()[i] - x0.data()[i]) <= bound);
                }
            }
        }
    }

    TEST_CASE_TEMPLATE("[EDM eq. 7] c_in z is the mixture the network was trained on", Real, float, double) {
        for (auto const predicted : predictions) {
            for (auto const level : levels) {
                auto const sigma = static_cast<Real>(level);
                auto const x0 = Real(-1.25);
                auto const n = Real(0.5);
                auto const input = scalings_of(predicted, sigma).c_in * (x0 + sigma * n);
                CHECK(std::abs(input - exact(predicted, x0, n, sigma).input) <=
                      16 * std::numeric_limits<Real>::epsilon());
            }
        }
    }

    TEST_CASE("[EDM eq. 7] without noise the clean estimate is z or what a clean network says") {
        CHECK(scalings_of(prediction::epsilon, 0.0).c_out == 0);
        CHECK(scalings_of(prediction::velocity, 0.0).c_out == 0);
        CHECK(scalings_of(prediction::flow, 0.0).c_out == 0);
        CHECK(scalings_of(prediction::clean, 0.0).c_skip == 0);
    }

    TEST_CASE("large levels stay finite in single precision") {
        for (auto const predicted : predictions) {
            auto const factors = scalings_of(predicted, 1e30F);
            CHECK(std::isfinite(factors.c_skip));
            CHECK(std::isfinite(factors.c_out));
            CHECK(factors.c_in > 0);
        }
    }

    TEST_CASE_TEMPLATE("a rectified flow is half way where noise and signal are alike", Real, float, double) {
        CHECK(flow_time_of(Real(0)) == Real(0));
        CHECK(flow_time_of(Real(1)) == Real(0.5));
        CHECK(flow_time_of(Real(3)) == Real(0.75));
    }

    TEST_CASE("the estimate may be written over z or over the network's output") {
        auto const z = normal_stack<double>(0);
        auto const F = normal_stack<double>(1);
        stack<double, 4> apart(z.extents());
        to_clean(apart.view(), prediction::velocity, z, F, 0.75);
        auto over_z = z;
        to_clean(over_z.view(), prediction::velocity, over_z, F, 0.75);
        auto over_F = F;
        to_clean(over_F.view(), prediction::velocity, z, over_F, 0.75);
        for (std::size_t i = 0; i < z.size(); ++i) {
            CHECK(over_z.data()[i] == apart.data()[i]);
            CHECK(over_F.data()[i] == apart.data()[i]);
        }
    }

    TEST_CASE("views of any strides are read in place") {
        // A channels-last network output [frames, height, width, channels] seen as [frames, channels, height, width].
        std::array<float, 12> const memory = {0, 6, 1, 7, 2, 8, 3, 9, 4, 10, 5, 11};
        strided_view<float const, 4> const F(memory.data(), {1, 2, 2, 3}, {12, 1, 6, 2});
        stack<float, 4> const z({1, 2, 2, 3});
        stack<float, 4> x0({1, 2, 2, 3});
        to_clean(x0.view(), prediction::clean, z, F, 1.0F);
        for (std::size_t i = 0; i < x0.size(); ++i) {
            CHECK(x0.data()[i] == static_cast<float>(i));
        }
    }

    TEST_CASE("wrong shapes and impossible levels are refused") {
        stack<double, 4> x0({1, 2, 2, 3});
        stack<double, 4> const other({1, 2, 3, 2});
        CHECK_THROWS_WITH_AS(to_clean(x0.view(), prediction::clean, other, x0, 1.0),
                             "to_clean: z is [1, 2, 3, 2], expected [1, 2, 2, 3]", shape_error);
        CHECK_THROWS_WITH_AS(to_clean(x0.view(), prediction::clean, x0, other, 1.0),
                             "to_clean: F is [1, 2, 3, 2], expected [1, 2, 2, 3]", shape_error);
        CHECK_THROWS_WITH_AS(to_clean(x0.view(), prediction::clean, x0, x0, -1.0),
                             "scalings_of: sigma is -1.000000, expected a finite number of at least 0", value_error);
        CHECK_THROWS_WITH_AS(scalings_of(prediction::flow, std::numeric_limits<double>::infinity()),
                             "scalings_of: sigma is inf, expected a finite number of at least 0", value_error);
        CHECK_THROWS_WITH_AS(scalings_of(static_cast<prediction>(9), 1.0),
                             "scalings_of: predicted is 9, expected epsilon, velocity, clean or flow", value_error);
        CHECK_THROWS_WITH_AS(flow_time_of(-0.5F),
                             "flow_time_of: sigma is -0.500000, expected a finite number of at least 0", value_error);
    }
}
