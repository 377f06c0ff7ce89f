// SPDX-License-Identifier: MIT
// What every sampler owes: one suite for all of them, and for one that somebody adds.
#pragma once

#include "analytic_denoisers.hpp"
#include "golden.hpp"
#include "sampler_latents.hpp"

#include <genrender/sampling/karras_schedule.hpp>
#include <genrender/sampling/preconditioning.hpp>
#include <genrender/sampling/sampler.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace genrender {

/// In what samplers differ.
struct sampler_facts {
    std::string name;        ///< in front of what it says
    sampler_kind method;     ///< as golden runs and evaluations() know it
    double order;            ///< of convergence
    double order_bound;      ///< how far the measured order may be from it
    std::size_t many_steps;  ///< of a run that ends
    double error_of_many;    ///< so close to the exact flow
    double error_of_network; ///< as are 400 steps through an exact network and its preconditioning
};

inline sampler_facts facts_of(sampler_kind method) {
    switch (method) {
    case sampler_kind::euler:
        return {"euler", method, 1, 0.05, 4000, 0.005, 0.02};
    case sampler_kind::heun:
        return {"heun", method, 2, 0.05, 1000, 1e-5, 0.001};
    default:
        return {"dpmpp_2m", method, 2, 0.1, 1000, 1e-4, 0.001};
    }
}

/// The sampler of a name as the properties call it: run(D, z, sigmas), with what is to happen after each step or
/// without.
struct sampler_by_name {
    sampler_kind method;

    template <class Denoise, class Latents, class Sigmas, class... AfterStep>
    Latents operator()(Denoise&& D, Latents z, Sigmas const& sigmas, AfterStep&&... after_step) const {
        return sample(method, std::forward<Denoise>(D), std::move(z), sigmas, after_step...);
    }
};

/// How far a run of `steps` steps from Stable Diffusion's highest level to its lowest ends from the exact flow.
template <class Run>
double error_of(Run const& run, std::size_t steps) {
    gaussian_denoiser const D;
    auto sigmas = karras_schedule<double>(steps + 1);
    sigmas.pop_back();
    double const z = run(D, 15.0, sigmas);
    return std::abs(z - D.exact(15.0, sigmas.front(), sigmas.back()));
}

/// The order of convergence: how many halvings of the error a halving of the steps' length brings.
template <class Run>
double order_of(Run const& run) {
    return std::log2(error_of(run, 200) / error_of(run, 400));
}

/// One step to level 0 gives the clean estimate to the bit.
template <class Real, class Run>
void check_step_to_level_0(Run const& run) {
    gaussian_denoiser const D;
    for (auto const z : {Real(-31.7), Real(0.3), Real(9), Real(12.9)}) {
        CHECK(run(D, z, std::vector<Real>{Real(14.6146), Real(0)}) == D(z, Real(14.6146)));
    }
    CHECK(run(D, Real(9), karras_schedule<Real>(1)) == D(Real(9), Real(14.6146)));
}

/// All golden runs of the method: the latents to 1e-12 of their size, and the number of evaluations.
template <class Run>
void check_golden_runs(Run const& run, sampler_facts const& facts) {
    auto const starts = golden::read_starts();
    std::size_t checked = 0;
    for (auto const& golden : golden::read_runs()) {
        if (golden.method != facts.method) {
            continue;
        }
        auto const sigmas = karras_schedule<double>(golden.steps);
        for (std::size_t i = 0; i < starts.size(); ++i) {
            std::size_t evaluations = 0;
            double const last = run(golden_denoiser{golden.of, &evaluations}, starts[i], sigmas);
            CHECK(std::abs(last - golden.last[i]) <= 1e-12 * std::abs(golden.last[i]));
            CHECK(evaluations == golden.evaluations);
            ++checked;
        }
    }
    CHECK(checked == 36);
}

/// Errors fall with the order of the method, and many steps end at the exact flow.
template <class Run>
void check_convergence(Run const& run, sampler_facts const& facts) {
    CHECK(order_of(run) > facts.order - facts.order_bound);
    CHECK(order_of(run) < facts.order + facts.order_bound);
    CHECK(error_of(run, facts.many_steps) < facts.error_of_many);

    // An exact network of the prior N(0, 1) through its preconditioning: its posterior mean of the noise given z is
    // z sigma / (1 + sigma^2).
    auto const D = [](double z, double sigma) {
        auto const factors = scalings_of(prediction::epsilon, sigma);
        auto const input = factors.c_in * z;
        auto const F = input * sigma / std::hypot(1.0, sigma);
        return factors.c_skip * z + factors.c_out * F;
    };
    auto const z_0 = gaussian_denoiser{0, 1}.exact(10.0, 14.6146, 0);
    CHECK(std::abs(run(D, 10.0, karras_schedule<double>(400)) - z_0) < facts.error_of_network);
}

/// evaluations() says how often a run asks D.
template <class Run>
void check_evaluations(Run const& run, sampler_facts const& facts) {
    for (std::size_t const steps : {1U, 2U, 50U}) {
        std::size_t found = 0;
        auto const D = [&](double z, double sigma) {
            ++found;
            return gaussian_denoiser{}(z, sigma);
        };
        run(D, 9.0, karras_schedule<double>(steps));
        CHECK(found == evaluations(facts.method, steps));
    }
}

/// A run is repeated to the bit, also when another run goes on inside of it.
template <class Run>
void check_keeps_nothing(Run const& run) {
    gaussian_denoiser const D;
    two_cluster_denoiser const other_D;
    auto const sigmas = karras_schedule<double>(9);
    auto const other_sigmas = karras_schedule<double>(4, 0.1, 3.0);
    double const alone = run(D, 11.0, sigmas);
    double const other_alone = run(other_D, -2.0, other_sigmas);
    CHECK(alone != other_alone);
    CHECK(run(D, 11.0, sigmas) == alone);

    std::size_t other_runs = 0;
    auto const interrupted = [&](double z, double sigma) {
        CHECK(run(other_D, -2.0, other_sigmas) == other_alone);
        ++other_runs;
        return D(z, sigma);
    };
    CHECK(run(interrupted, 11.0, sigmas) == alone);
    CHECK(other_runs >= 9);
}

/// after_step sees each step, and what it leaves is what the next step starts from.
template <class Real, class Run>
void check_after_step(Run const& run, sampler_facts const& facts) {
    std::vector<Real> seen;
    std::vector<Real> started; // what the first evaluation of each step is asked for
    std::vector<std::size_t> steps;
    std::size_t asked = 0;
    auto const D = [&](Real z, Real) {
        ++asked;
        if (started.size() == steps.size()) {
            started.push_back(z);
        }
        return Real(0);
    };
    auto const last = run(D, Real(8), std::vector<Real>{8, 4, 2, 0}, [&](std::size_t step, Real& z) {
        steps.push_back(step);
        seen.push_back(z);
        z += 1;
    });
    CHECK(steps == std::vector<std::size_t>{0, 1, 2});
    CHECK(seen == std::vector<Real>{4, Real(2.5), 0});
    CHECK(started == std::vector<Real>{8, 5, Real(3.5)});
    CHECK(asked == evaluations(facts.method, 3));
    CHECK(last == Real(1));

    steps.clear();
    auto const nothing = [](Real, Real) { return Real(0); };
    auto const tripled = run(nothing, Real(8), std::vector<Real>{8, 4, 2}, [&](std::size_t step, Real& z) {
        steps.push_back(step);
        z *= 3;
    });
    CHECK(steps == std::vector<std::size_t>{0, 1});
    CHECK(tripled == Real(18));
}

/// An exception of after_step ends the run: this is how runs are cancelled.
template <class Run>
void check_cancellation(Run const& run, sampler_facts const& facts) {
    std::size_t asked = 0;
    auto const D = [&](double z, double) {
        ++asked;
        return z;
    };
    auto const stop = [](std::size_t step, double&) {
        if (step == 1) {
            throw cancelled("enough");
        }
    };
    CHECK_THROWS_WITH_AS(run(D, 1.0, karras_schedule<double>(5), stop), "enough", cancelled);
    CHECK(asked == evaluations(facts.method, 3) - evaluations(facts.method, 1)); // of two steps
}

/// Levels that do not fall are refused before the first evaluation.
template <class Run>
void check_refusals(Run const& run, sampler_facts const& facts) {
    auto const never = [](double, double) -> double { throw std::logic_error("evaluated"); };
    auto const said = [&](char const* text) { return facts.name + ": " + text; };
    CHECK_THROWS_WITH_AS(run(never, 1.0, std::vector<double>{}), said("sigmas is [0], expected at least [2]").c_str(),
                         shape_error);
    CHECK_THROWS_WITH_AS(run(never, 1.0, std::vector{1.0}), said("sigmas is [1], expected at least [2]").c_str(),
                         shape_error);
    CHECK_THROWS_WITH_AS(run(never, 1.0, std::vector{1.0, 2.0}),
                         said("sigmas[1] is 2.000000, expected less than sigmas[0]").c_str(), value_error);
    CHECK_THROWS_WITH_AS(run(never, 1.0, std::vector{2.0, 3.0}),
                         said("sigmas[1] is 3.000000, expected less than sigmas[0]").c_str(), value_error);
    CHECK_THROWS_WITH_AS(run(never, 1.0, std::vector{2.0, 0.0, 0.0}),
                         said("sigmas[2] is 0.000000, expected less than sigmas[1]").c_str(), value_error);
    CHECK_THROWS_WITH_AS(run(never, 1.0, std::vector{std::numeric_limits<double>::quiet_NaN(), 0.0}),
                         said("sigmas[0] is nan, expected a finite number of at least 0").c_str(), value_error);
}

/// All of it.
template <class Run>
void check_sampler_properties(Run const& run, sampler_facts const& facts) {
    SUBCASE("one step to level 0 gives the clean estimate to the bit") {
        check_step_to_level_0<float>(run);
        check_step_to_level_0<double>(run);
    }
    SUBCASE("runs agree with k-diffusion") { check_golden_runs(run, facts); }
    SUBCASE("errors fall with the method's order and many steps end at the exact flow") {
        check_convergence(run, facts);
    }
    SUBCASE("evaluations says how often a run evaluates D") { check_evaluations(run, facts); }
    SUBCASE("a run keeps nothing for the next and nothing of another") { check_keeps_nothing(run); }
    SUBCASE("after_step sees each step and what it leaves is what the next step starts from") {
        check_after_step<float>(run, facts);
        check_after_step<double>(run, facts);
    }
    SUBCASE("an exception of after_step ends the run") { check_cancellation(run, facts); }
    SUBCASE("levels that do not fall are refused before the first evaluation") { check_refusals(run, facts); }
    SUBCASE("single precision follows double precision") { check_precisions(run); }
    SUBCASE("every element of an xtensor of latents goes its own way") {
        check_xtensor<float>(run);
        check_xtensor<double>(run);
    }
    SUBCASE("every element of an Eigen array goes its own way") {
        check_eigen<float>(run);
        check_eigen<double>(run);
    }
    SUBCASE("D and after_step are used in place and never copied") { check_copies_nothing(run); }
}

} // namespace genrender
