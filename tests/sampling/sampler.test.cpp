// SPDX-License-Identifier: MIT
// [EDM alg. 1] The samplers by name.
#include <genrender/sampling/sampler.hpp>

#include <doctest/doctest.h>

#include "analytic_denoisers.hpp"
#include <genrender/core/linalg.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

using namespace genrender;

namespace {

constexpr std::array samplers = {sampler::euler, sampler::heun, sampler::dpmpp_2m};

/// A clean estimate that may be moved but not copied.
struct sole_denoiser {
    std::unique_ptr<double> s = std::make_unique<double>(0.5);
    double operator()(double z, double sigma) const { return two_cluster_denoiser{*s}(z, sigma); }
};

} // namespace

TEST_SUITE("sampling/sampler") {
    TEST_CASE("a sampler by name is the sampler") {
        gaussian_denoiser const D;
        auto const sigmas = karras_schedule<double>(6);
        CHECK(sample(sampler::euler, D, 9.0, sigmas) == euler(D, 9.0, sigmas));
        CHECK(sample(sampler::heun, D, 9.0, sigmas) == heun(D, 9.0, sigmas));
        CHECK(sample(sampler::dpmpp_2m, D, 9.0, sigmas) == dpmpp_2m(D, 9.0, sigmas));
        CHECK(euler(D, 9.0, sigmas) != heun(D, 9.0, sigmas));
        CHECK(euler(D, 9.0, sigmas) != dpmpp_2m(D, 9.0, sigmas));
    }

    TEST_CASE("evaluations says how often a run evaluates D") {
        for (auto const method : samplers) {
            for (std::size_t const steps : {1U, 2U, 50U}) {
                std::size_t found = 0;
                auto const D = [&](double z, double sigma) {
                    ++found;
                    return gaussian_denoiser{}(z, sigma);
                };
                sample(method, D, 9.0, karras_schedule<double>(steps));
                CHECK(found == evaluations(method, steps));
            }
        }
        CHECK(evaluations(sampler::euler, 50) == 50);
        CHECK(evaluations(sampler::heun, 50) == 99);
        CHECK(evaluations(sampler::dpmpp_2m, 50) == 50);
    }

    TEST_CASE_TEMPLATE("one step is a number with every sampler", Real, float, double) {
        gaussian_denoiser const D;
        for (auto const method : samplers) {
            auto const z = sample(method, D, Real(9), karras_schedule<Real>(1));
            CHECK(z == D(Real(9), Real(14.6146)));
        }
    }

    TEST_CASE("single precision follows double precision") {
        gaussian_denoiser const D;
        for (auto const method : samplers) {
            auto const in_float = sample(method, D, 9.0F, karras_schedule<float>(50));
            auto const in_double = sample(method, D, 9.0, karras_schedule<double>(50));
            // 50 steps, each rounding latents of at most 9.
            CHECK(std::abs(static_cast<double>(in_float) - in_double) < 50 * 9 * 1.2e-7);
        }
    }

    TEST_CASE_TEMPLATE("every element of an xtensor of latents goes its own way", Real, float, double) {
        gaussian_denoiser const scalar_D;
        // The return type evaluates the lazy expression while mean and variance are alive.
        auto const D = [](latents<Real> const& z, Real sigma) -> latents<Real> {
            auto const variance = static_cast<Real>(1.3 * 1.3);
            auto const mean = sigma * sigma * static_cast<Real>(0.7);
            return (variance * z + mean) / (variance + sigma * sigma);
        };
        auto const sigmas = karras_schedule<Real>(7);
        auto const z_T = latents<Real>(std::array<std::size_t, 4>{2, 2, 3, 3}, Real(-20));
        for (auto const method : samplers) {
            auto z = z_T;
            z(1, 0, 2, 1) = Real(13);
            auto const last = sample(method, D, z, std::span<Real const>(sigmas));
            auto const expected = sample(method, scalar_D, Real(-20), sigmas);
            auto const expected_there = sample(method, scalar_D, Real(13), sigmas);
            auto const bound = 100 * std::numeric_limits<Real>::epsilon();
            CHECK(std::abs(last(0, 0, 0, 0) - expected) < bound);
            CHECK(std::abs(last(1, 1, 2, 2) - expected) < bound);
            CHECK(std::abs(last(1, 0, 2, 1) - expected_there) < bound);
        }
    }

    TEST_CASE_TEMPLATE("every element of an Eigen array goes its own way", Real, float, double) {
        using array = Eigen::Array<Real, Eigen::Dynamic, 1>;
        two_cluster_denoiser const scalar_D;
        auto const D = [&](array const& z, Real sigma) -> array {
            return z.unaryExpr([&](Real value) { return scalar_D(value, sigma); });
        };
        auto const sigmas = karras_schedule<Real>(7);
        array z(2);
        z << Real(-20), Real(13);
        for (auto const method : samplers) {
            array const last = sample(method, D, z, sigmas, [](std::size_t, array& after) { after += Real(0); });
            for (Eigen::Index i = 0; i < z.size(); ++i) {
                auto const expected = sample(method, scalar_D, z(i), sigmas);
                CHECK(std::abs(last(i) - expected) < 100 * std::numeric_limits<Real>::epsilon());
            }
        }
    }

    TEST_CASE("an exact network through its preconditioning leads where the exact flow leads") {
        // The prior N(0, 1): its posterior mean of the noise given z is z sigma / (1 + sigma^2).
        auto const D = [](double z, double sigma) {
            auto const factors = scalings_of(prediction::epsilon, sigma);
            auto const input = factors.c_in * z;
            auto const F = input * sigma / std::hypot(1.0, sigma);
            return factors.c_skip * z + factors.c_out * F;
        };
        auto const z_0 = gaussian_denoiser{0, 1}.exact(10.0, 14.6146, 0);
        auto const sigmas = karras_schedule<double>(400);
        CHECK(std::abs(heun(D, 10.0, sigmas) - z_0) < 0.001);
        CHECK(std::abs(dpmpp_2m(D, 10.0, sigmas) - z_0) < 0.001);
        CHECK(std::abs(euler(D, 10.0, sigmas) - z_0) < 0.02);
    }

    TEST_CASE("D and after_step are used in place and never copied") {
        auto const after = [sole = std::make_unique<int>(0)](std::size_t, double&) { ++*sole; };
        sole_denoiser const D;
        for (auto const method : samplers) {
            CHECK(sample(method, D, 3.0, karras_schedule<double>(4), after) ==
                  sample(method, sole_denoiser{}, 3.0, karras_schedule<double>(4)));
        }
    }

    TEST_CASE("what names no sampler and no step is refused") {
        auto const none = static_cast<sampler>(7);
        CHECK_THROWS_WITH_AS(sample(none, gaussian_denoiser{}, 1.0, std::vector{1.0, 0.0}),
                             "sample: method is 7, expected euler, heun or dpmpp_2m", value_error);
        CHECK_THROWS_WITH_AS(evaluations(none, 3), "evaluations: method is 7, expected euler, heun or dpmpp_2m",
                             value_error);
        CHECK_THROWS_WITH_AS(evaluations(sampler::heun, 0), "evaluations: steps is 0, expected at least 1",
                             value_error);
        CHECK_THROWS_WITH_AS(sample(sampler::heun, gaussian_denoiser{}, 1.0, std::vector{1.0}),
                             "heun: sigmas is [1], expected at least [2]", shape_error);
    }
}
