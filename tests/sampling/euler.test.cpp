// SPDX-License-Identifier: MIT
// [EDM alg. 1] Euler's method.
#include <genrender/sampling/euler.hpp>

#include <doctest/doctest.h>

#include "analytic_denoisers.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

using namespace genrender;

namespace {

auto const by_euler = [](auto const& D, double z, std::vector<double> const& sigmas) { return euler(D, z, sigmas); };

} // namespace

TEST_SUITE("sampling/euler") {
    TEST_CASE("[EDM alg. 1] one step by hand") {
        // d = (5 - 1) / 4 = 1, so z falls by 4 - 3 = 1.
        CHECK(euler_step(5.0, 1.0, 4.0, 3.0) == 4.0);
        // Two steps towards a clean estimate of 0 from 8 at level 4: 8, 4, 2.
        auto const nothing = [](double, double) { return 0.0; };
        CHECK(euler(nothing, 8.0, std::vector{4.0, 2.0, 1.0}) == 2.0);
    }

    TEST_CASE_TEMPLATE("[EDM alg. 1] one step to level 0 gives the clean estimate to the bit", Real, float, double) {
        gaussian_denoiser const D;
        for (auto const z : {Real(-31.7), Real(0.3), Real(12.9)}) {
            CHECK(euler(D, z, std::vector<Real>{Real(14.6146), Real(0)}) == D(z, Real(14.6146)));
        }
    }

    TEST_CASE("[EDM alg. 1] runs agree with k-diffusion") { check_golden_runs(sampler::euler, by_euler); }

    TEST_CASE("[EDM alg. 1] Euler's method is of first order") {
        CHECK(order_of(by_euler) > 0.95);
        CHECK(order_of(by_euler) < 1.05);
    }

    TEST_CASE("many steps end at the exact flow") { CHECK(error_of(by_euler, 4000) < 0.005); }

    TEST_CASE("a run keeps nothing for the next and nothing of another") { check_keeps_nothing(by_euler); }

    TEST_CASE_TEMPLATE("after_step sees each step and what it leaves is what the next step starts from", Real, float,
                       double) {
        std::vector<Real> seen;
        std::vector<Real> asked;
        std::vector<std::size_t> steps;
        auto const D = [&](Real z, Real) {
            asked.push_back(z);
            return Real(0);
        };
        auto const last = euler(D, Real(8), std::vector<Real>{8, 4, 2, 0}, [&](std::size_t step, Real& z) {
            steps.push_back(step);
            seen.push_back(z);
            z += 1;
        });
        CHECK(steps == std::vector<std::size_t>{0, 1, 2});
        CHECK(seen == std::vector<Real>{4, Real(2.5), 0});
        CHECK(asked == std::vector<Real>{8, 5, Real(3.5)});
        CHECK(last == Real(1));
    }

    TEST_CASE("an exception of after_step ends the run") {
        std::size_t evaluations = 0;
        auto const D = [&](double z, double) {
            ++evaluations;
            return z;
        };
        auto const stop = [](std::size_t step, double&) {
            if (step == 1) {
                throw cancelled("enough");
            }
        };
        CHECK_THROWS_WITH_AS(euler(D, 1.0, karras_schedule<double>(5), stop), "enough", cancelled);
        CHECK(evaluations == 2);
    }

    TEST_CASE("levels that do not fall are refused before the first evaluation") {
        auto const never = [](double, double) -> double { throw std::logic_error("evaluated"); };
        CHECK_THROWS_WITH_AS(euler(never, 1.0, std::vector{1.0}), "euler: sigmas is [1], expected at least [2]",
                             shape_error);
        CHECK_THROWS_WITH_AS(euler(never, 1.0, std::vector{1.0, 2.0}),
                             "euler: sigmas[1] is 2.000000, expected less than sigmas[0]", value_error);
        CHECK_THROWS_WITH_AS(euler(never, 1.0, std::vector{std::numeric_limits<double>::quiet_NaN(), 0.0}),
                             "euler: sigmas[0] is nan, expected a finite number of at least 0", value_error);
    }
}
