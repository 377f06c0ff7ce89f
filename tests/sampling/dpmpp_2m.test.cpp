// SPDX-License-Identifier: MIT
// [DPM++ alg. 2] DPM-Solver++(2M).
#include <genrender/sampling/dpmpp_2m.hpp>

#include <doctest/doctest.h>

#include "analytic_denoisers.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

using namespace genrender;

namespace {

auto const by_dpmpp_2m = [](auto const& D, double z, std::vector<double> const& sigmas) {
    return dpmpp_2m(D, z, sigmas);
};
auto const by_euler = [](auto const& D, double z, std::vector<double> const& sigmas) { return euler(D, z, sigmas); };

} // namespace

TEST_SUITE("sampling/dpmpp_2m") {
    TEST_CASE("[DPM++ alg. 2] two steps by hand") {
        // D = sigma, from 8 at level 4, each step as long as the last in log sigma (h = h_last = log 2).
        // First step: 8 / 2 + 4 / 2 = 6. Second: x0 = 2 + (2 - 4) / 2 = 1, so 6 / 2 + 1 / 2 = 3.5.
        auto const level = [](double, double sigma) { return sigma; };
        CHECK(dpmpp_2m(level, 8.0, std::vector{4.0, 2.0, 1.0}) == doctest::Approx(3.5).epsilon(1e-15));
        // Second step four times as long: x0 = 2 + 4 / 2 (2 - 4) = -2, so 6 / 16 - 2 * 15 / 16 = -1.5.
        CHECK(dpmpp_2m(level, 8.0, std::vector{4.0, 2.0, 0.125}) == doctest::Approx(-1.5).epsilon(1e-14));
    }

    TEST_CASE_TEMPLATE("[DPM++ alg. 2] one step to level 0 gives the clean estimate to the bit", Real, float, double) {
        gaussian_denoiser const D;
        for (auto const z : {Real(-31.7), Real(0.3), Real(12.9)}) {
            CHECK(dpmpp_2m(D, z, std::vector<Real>{Real(14.6146), Real(0)}) == D(z, Real(14.6146)));
        }
    }

    TEST_CASE("[DPM++ alg. 2] runs agree with k-diffusion") { check_golden_runs(sampler::dpmpp_2m, by_dpmpp_2m); }

    TEST_CASE("[DPM++ alg. 2] DPM-Solver++(2M) is of second order") {
        CHECK(order_of(by_dpmpp_2m) > 1.9);
        CHECK(order_of(by_dpmpp_2m) < 2.1);
    }

    TEST_CASE("the same number of evaluations goes further than with Euler's method") {
        for (std::size_t const steps : {10U, 20U, 50U}) {
            CHECK(error_of(by_dpmpp_2m, steps) < 0.5 * error_of(by_euler, steps));
        }
    }

    TEST_CASE("many steps end at the exact flow") { CHECK(error_of(by_dpmpp_2m, 1000) < 1e-4); }

    TEST_CASE("the last step to level 0 forgets the past") {
        // Its result is the clean estimate itself, however different the one before was.
        auto const level = [](double, double sigma) { return sigma; };
        CHECK(dpmpp_2m(level, 8.0, std::vector{4.0, 1.0, 0.0}) == 1.0);
    }

    TEST_CASE("a run keeps nothing for the next and nothing of another") { check_keeps_nothing(by_dpmpp_2m); }

    TEST_CASE_TEMPLATE("after_step is called once a step and may change the latents", Real, float, double) {
        std::vector<std::size_t> steps;
        auto const nothing = [](Real, Real) { return Real(0); };
        auto const last = dpmpp_2m(nothing, Real(8), std::vector<Real>{8, 4, 2}, [&](std::size_t step, Real& z) {
            steps.push_back(step);
            z *= 3;
        });
        CHECK(steps == std::vector<std::size_t>{0, 1});
        CHECK(last == Real(18));
    }

    TEST_CASE("levels that do not fall are refused before the first evaluation") {
        auto const never = [](double, double) -> double { throw std::logic_error("evaluated"); };
        CHECK_THROWS_WITH_AS(dpmpp_2m(never, 1.0, std::vector{1.0}), "dpmpp_2m: sigmas is [1], expected at least [2]",
                             shape_error);
        CHECK_THROWS_WITH_AS(dpmpp_2m(never, 1.0, std::vector{2.0, 3.0}),
                             "dpmpp_2m: sigmas[1] is 3.000000, expected less than sigmas[0]", value_error);
    }
}
