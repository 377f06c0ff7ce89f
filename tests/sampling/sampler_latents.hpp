// SPDX-License-Identifier: MIT
// What every sampler owes to latents of any type: scalars of both precisions, xtensor, Eigen.
#pragma once

#include "analytic_denoisers.hpp"

#include <genrender/core/linalg.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/sampling/karras_schedule.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>

namespace genrender {

/// Single precision follows double precision.
template <class Run>
void check_precisions(Run const& run) {
    gaussian_denoiser const D;
    auto const in_float = run(D, 9.0F, karras_schedule<float>(50));
    auto const in_double = run(D, 9.0, karras_schedule<double>(50));
    // 50 steps, each rounding latents of at most 9.
    CHECK(std::abs(static_cast<double>(in_float) - in_double) < 50 * 9 * 1.2e-7);
}

/// Every element of an xtensor of latents goes its own way.
template <class Real, class Run>
void check_xtensor(Run const& run) {
    gaussian_denoiser const scalar_D;
    // The return type evaluates the lazy expression while mean and variance are alive.
    auto const D = [](latents<Real> const& z, Real sigma) -> latents<Real> {
        auto const variance = static_cast<Real>(1.3 * 1.3);
        auto const mean = sigma * sigma * static_cast<Real>(0.7);
        return (variance * z + mean) / (variance + sigma * sigma);
    };
    auto const sigmas = karras_schedule<Real>(7);
    auto z = latents<Real>(std::array<std::size_t, 4>{2, 2, 3, 3}, Real(-20));
    z(1, 0, 2, 1) = Real(13);
    auto const last = run(D, z, std::span<Real const>(sigmas));
    auto const expected = run(scalar_D, Real(-20), sigmas);
    auto const expected_there = run(scalar_D, Real(13), sigmas);
    auto const bound = 100 * std::numeric_limits<Real>::epsilon();
    CHECK(std::abs(last(0, 0, 0, 0) - expected) < bound);
    CHECK(std::abs(last(1, 1, 2, 2) - expected) < bound);
    CHECK(std::abs(last(1, 0, 2, 1) - expected_there) < bound);
}

/// Every element of an Eigen array goes its own way.
template <class Real, class Run>
void check_eigen(Run const& run) {
    using array = Eigen::Array<Real, Eigen::Dynamic, 1>;
    two_cluster_denoiser const scalar_D;
    auto const D = [&](array const& z, Real sigma) -> array {
        return z.unaryExpr([&](Real value) { return scalar_D(value, sigma); });
    };
    auto const sigmas = karras_schedule<Real>(7);
    array z(2);
    z << Real(-20), Real(13);
    array const last = run(D, z, sigmas, [](std::size_t, array& after) { after += Real(0); });
    for (Eigen::Index i = 0; i < z.size(); ++i) {
        auto const expected = run(scalar_D, z(i), sigmas);
        CHECK(std::abs(last(i) - expected) < 100 * std::numeric_limits<Real>::epsilon());
    }
}

/// A clean estimate that may be moved but not copied.
struct sole_denoiser {
    std::unique_ptr<double> s = std::make_unique<double>(0.5);
    double operator()(double z, double sigma) const { return two_cluster_denoiser{*s}(z, sigma); }
};

/// D and after_step are used in place and never copied.
template <class Run>
void check_copies_nothing(Run const& run) {
    auto const after = [sole = std::make_unique<int>(0)](std::size_t, double&) { ++*sole; };
    sole_denoiser const D;
    CHECK(run(D, 3.0, karras_schedule<double>(4), after) == run(sole_denoiser{}, 3.0, karras_schedule<double>(4)));
}

} // namespace genrender
