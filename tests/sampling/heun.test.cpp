// SPDX-License-Identifier: MIT
// [EDM alg. 1] Heun's method.
#include <genrender/sampling/heun.hpp>

#include <doctest/doctest.h>

#include "analytic_denoisers.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

using namespace genrender;

namespace {

auto const by_heun = [](auto const& D, double z, std::vector<double> const& sigmas) { return heun(D, z, sigmas); };

} // namespace

TEST_SUITE("sampling/heun") {
    TEST_CASE("[EDM alg. 1] one step by hand") {
        // D = sigma. From 8 at level 4: d = (8 - 4) / 4 = 1, Euler's step ends at 6 at level 2, where d = (6 - 2) / 2
        // = 2. Along the mean 1.5 z falls by 3.
        auto const level = [](double, double sigma) { return sigma; };
        CHECK(heun(level, 8.0, std::vector{4.0, 2.0}) == 5.0);
    }

    TEST_CASE_TEMPLATE("[EDM alg. 1] one step to level 0 gives the clean estimate to the bit", Real, float, double) {
        gaussian_denoiser const D;
        for (auto const z : {Real(-31.7), Real(0.3), Real(12.9)}) {
            CHECK(heun(D, z, std::vector<Real>{Real(14.6146), Real(0)}) == D(z, Real(14.6146)));
        }
    }

    TEST_CASE("[EDM alg. 1] runs agree with k-diffusion") { check_golden_runs(sampler::heun, by_heun); }

    TEST_CASE("[EDM alg. 1] Heun's method is of second order") {
        CHECK(order_of(by_heun) > 1.95);
        CHECK(order_of(by_heun) < 2.05);
    }

    TEST_CASE("many steps end at the exact flow") { CHECK(error_of(by_heun, 1000) < 1e-5); }

    TEST_CASE("[EDM alg. 1] a step is evaluated at both of its levels but never at 0") {
        std::vector<double> asked;
        auto const D = [&](double z, double sigma) {
            asked.push_back(sigma);
            return z / 2;
        };
        heun(D, 1.0, std::vector{3.0, 2.0, 1.0, 0.0});
        CHECK(asked == std::vector{3.0, 2.0, 2.0, 1.0, 1.0});
        asked.clear();
        heun(D, 1.0, std::vector{3.0, 2.0, 1.0});
        CHECK(asked == std::vector{3.0, 2.0, 2.0, 1.0});
    }

    TEST_CASE("a run keeps nothing for the next and nothing of another") { check_keeps_nothing(by_heun); }

    TEST_CASE_TEMPLATE("after_step is called once a step and may change the latents", Real, float, double) {
        std::vector<std::size_t> steps;
        auto const nothing = [](Real, Real) { return Real(0); };
        auto const last = heun(nothing, Real(8), std::vector<Real>{8, 4, 2}, [&](std::size_t step, Real& z) {
            steps.push_back(step);
            z *= 3;
        });
        CHECK(steps == std::vector<std::size_t>{0, 1});
        CHECK(last == Real(18));
    }

    TEST_CASE("levels that do not fall are refused before the first evaluation") {
        auto const never = [](double, double) -> double { throw std::logic_error("evaluated"); };
        CHECK_THROWS_WITH_AS(heun(never, 1.0, std::vector<double>{}), "heun: sigmas is [0], expected at least [2]",
                             shape_error);
        CHECK_THROWS_WITH_AS(heun(never, 1.0, std::vector{2.0, 0.0, 0.0}),
                             "heun: sigmas[2] is 0.000000, expected less than sigmas[1]", value_error);
    }
}
