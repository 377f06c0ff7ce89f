// SPDX-License-Identifier: MIT
// [EDM sec. 5, table 1] The noise levels of a network's training.
#include <genrender/sampling/noise_schedule.hpp>

#include <doctest/doctest.h>

#include "golden.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace genrender;

namespace {

double relative_error(double found, double expected) { return std::abs(found - expected) / std::abs(expected); }

} // namespace

TEST_SUITE("sampling/noise_schedule") {
    TEST_CASE("alpha_bar is the running product of 1 - beta") {
        // sqrt(beta) = 0.1, 0.2, 0.3, so beta = 0.01, 0.04, 0.09.
        auto const alphas_cumprod = scaled_linear_alphas_cumprod(0.01, 0.09, 3);
        REQUIRE(alphas_cumprod.size() == 3);
        CHECK(alphas_cumprod[0] == doctest::Approx(0.99).epsilon(1e-14));
        CHECK(alphas_cumprod[1] == doctest::Approx(0.99 * 0.96).epsilon(1e-14));
        CHECK(alphas_cumprod[2] == doctest::Approx(0.99 * 0.96 * 0.91).epsilon(1e-14));
    }

    TEST_CASE("Stable Diffusion's levels run from 0.0292 to 14.6146 in 1000 steps") {
        discrete_noise_schedule const schedule;
        CHECK(schedule.size() == 1000);
        CHECK(std::abs(schedule.sigma_min() - 0.0292) < 0.00005);
        CHECK(std::abs(schedule.sigma_max() - 14.6146) < 0.00005);
    }

    TEST_CASE("a level is the ratio of noise to signal at its step") {
        // alpha_bar = 0.8 is half as much noise as signal by amplitude, 0.5 as much, 0.2 twice as much.
        discrete_noise_schedule const schedule(std::array{0.8, 0.5, 0.2});
        CHECK(schedule.sigma_of(0.0) == doctest::Approx(0.5).epsilon(1e-14));
        CHECK(schedule.sigma_of(1.0) == doctest::Approx(1.0).epsilon(1e-14));
        CHECK(schedule.sigma_of(2.0) == doctest::Approx(2.0).epsilon(1e-14));
    }

    TEST_CASE("between two steps log sigma is linear") {
        discrete_noise_schedule const schedule(std::array{0.8, 0.5, 0.2});
        CHECK(schedule.sigma_of(0.5) == doctest::Approx(std::sqrt(0.5)).epsilon(1e-14));
        CHECK(schedule.sigma_of(1.25) == doctest::Approx(std::pow(2.0, 0.25)).epsilon(1e-14));
        CHECK(schedule.t_of(std::pow(2.0, 0.25)) == doctest::Approx(1.25).epsilon(1e-14));
    }

    TEST_CASE("levels and times agree with k-diffusion") {
        discrete_noise_schedule const schedule;
        auto const [times, sigmas_of_times] = golden::read_levels_of_times();
        for (std::size_t i = 0; i < times.size(); ++i) {
            CHECK(relative_error(schedule.sigma_of(times[i]), sigmas_of_times[i]) < 1e-10);
        }
        auto const [levels, times_of_levels] = golden::read_times_of_levels();
        for (std::size_t i = 0; i < levels.size(); ++i) {
            CHECK(std::abs(schedule.t_of(levels[i]) - times_of_levels[i]) < 1e-8);
        }
    }

    TEST_CASE_TEMPLATE("t_of is the inverse of sigma_of", Real, float, double) {
        discrete_noise_schedule const schedule;
        // One rounding of sigma moves t by epsilon / (d log sigma / d t), and that slope is at least 0.002.
        auto const bound = 1000 * std::numeric_limits<Real>::epsilon();
        for (Real t = 0; t <= 999; t += Real(0.37)) {
            CHECK(std::abs(schedule.t_of(schedule.sigma_of(t)) - t) <= bound);
        }
    }

    TEST_CASE_TEMPLATE("beyond the ends counts as the ends", Real, float, double) {
        discrete_noise_schedule const schedule;
        auto const infinity = std::numeric_limits<Real>::infinity();
        CHECK(schedule.sigma_of(Real(-3)) == schedule.sigma_of(Real(0)));
        CHECK(schedule.sigma_of(Real(999.5)) == schedule.sigma_of(Real(999)));
        CHECK(schedule.sigma_of(infinity) == schedule.sigma_of(Real(999)));
        CHECK(schedule.t_of(Real(0)) == Real(0));
        CHECK(schedule.t_of(Real(0.029)) == Real(0));
        CHECK(schedule.t_of(Real(15)) == Real(999));
        CHECK(schedule.t_of(infinity) == Real(999));
    }

    TEST_CASE("impossible betas are refused") {
        CHECK_THROWS_WITH_AS(scaled_linear_alphas_cumprod(0.0),
                             "scaled_linear_alphas_cumprod: beta_first is 0.000000, expected a number in (0, 1)",
                             value_error);
        CHECK_THROWS_WITH_AS(
            scaled_linear_alphas_cumprod(0.5, 0.25),
            "scaled_linear_alphas_cumprod: beta_last is 0.250000, expected a number in [beta_first, 1)", value_error);
        CHECK_THROWS_WITH_AS(
            scaled_linear_alphas_cumprod(0.25, 1.0),
            "scaled_linear_alphas_cumprod: beta_last is 1.000000, expected a number in [beta_first, 1)", value_error);
        CHECK_THROWS_WITH_AS(scaled_linear_alphas_cumprod(0.25, 0.5, 1),
                             "scaled_linear_alphas_cumprod: steps is 1, expected at least 2", value_error);
    }

    TEST_CASE("impossible levels and times are refused") {
        CHECK_THROWS_WITH_AS(discrete_noise_schedule(std::array{0.5}),
                             "discrete_noise_schedule: alphas_cumprod is [1], expected at least [2]", shape_error);
        auto const falling = "expected values that fall strictly within (0, 1)";
        auto const text = [&](char const* found) {
            return std::string("discrete_noise_schedule: alphas_cumprod is ") + found + ", " + falling;
        };
        CHECK_THROWS_WITH_AS(discrete_noise_schedule(std::array{0.5, 0.5}), text("0.500000").c_str(), value_error);
        CHECK_THROWS_WITH_AS(discrete_noise_schedule(std::array{1.0, 0.5}), text("1.000000").c_str(), value_error);
        CHECK_THROWS_WITH_AS(discrete_noise_schedule(std::array{0.5, 0.0}), text("0.000000").c_str(), value_error);

        discrete_noise_schedule const schedule;
        auto const nan = std::numeric_limits<double>::quiet_NaN();
        CHECK_THROWS_WITH_AS(schedule.sigma_of(nan), "sigma_of: t is nan, expected a number", value_error);
        CHECK_THROWS_WITH_AS(schedule.t_of(nan), "t_of: sigma is nan, expected at least 0", value_error);
        CHECK_THROWS_WITH_AS(schedule.t_of(-1.0), "t_of: sigma is -1.000000, expected at least 0", value_error);
    }
}
