// SPDX-License-Identifier: MIT
// Clean estimates known in closed form, for samplers to follow, and what golden.hpp knows of where they lead.
#pragma once

#include "golden.hpp"

#include <doctest/doctest.h>

#include <genrender/sampling/karras_schedule.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace genrender {

/// The posterior mean of x0 under the prior N(mu, s^2).
struct gaussian_denoiser {
    double mu = 0.7;
    double s = 1.3;

    // Compiled once: where it is inlined, targets with fused multiply-adds may round it in more than one way.
    template <class Real>
    [[gnu::noinline]] Real operator()(Real z, Real sigma) const {
        auto const variance = static_cast<Real>(s * s);
        return (variance * z + sigma * sigma * static_cast<Real>(mu)) / (variance + sigma * sigma);
    }

    /// Where the flow dz/dsigma = (z - D(z, sigma)) / sigma leads from z at sigma_first: at every level z - mu is the
    /// same multiple of its standard deviation, sqrt(s^2 + sigma^2).
    double exact(double z, double sigma_first, double sigma) const {
        return mu + (z - mu) * std::hypot(s, sigma) / std::hypot(s, sigma_first);
    }
};

/// The posterior mean of x0 under a prior of two equally likely clusters, N(-1, s^2) and N(1, s^2); s = 0 is two
/// points.
struct two_cluster_denoiser {
    double s = 0.5;

    template <class Real>
    Real operator()(Real z, Real sigma) const {
        auto const variance = static_cast<Real>(s * s);
        auto const total = variance + sigma * sigma;
        return (variance * z + sigma * sigma * std::tanh(z / total)) / total;
    }
};

/// The clean estimate of a golden run, counting how often it is asked.
struct golden_denoiser {
    golden::prior of;
    std::size_t* evaluations;

    double operator()(double z, double sigma) const {
        ++*evaluations;
        switch (of) {
        case golden::prior::gaussian:
            return gaussian_denoiser{0.7, 1.3}(z, sigma);
        case golden::prior::two_points:
            return two_cluster_denoiser{0}(z, sigma);
        case golden::prior::two_clusters:
            return two_cluster_denoiser{0.5}(z, sigma);
        }
        return 0;
    }
};

/// Checks `sample(D, z, sigmas)` against all golden runs of a method: the latents to 1e-12 of their size, and the
/// number of evaluations.
template <class Sample>
void check_golden_runs(sampler method, Sample const& sample) {
    std::size_t checked = 0;
    for (auto const& run : golden::runs) {
        if (run.method != method) {
            continue;
        }
        auto const sigmas = karras_schedule<double>(run.steps);
        for (std::size_t i = 0; i < golden::starts.size(); ++i) {
            std::size_t evaluations = 0;
            double const last = sample(golden_denoiser{run.of, &evaluations}, golden::starts[i], sigmas);
            CHECK(std::abs(last - run.last[i]) <= 1e-12 * std::abs(run.last[i]));
            CHECK(evaluations == run.evaluations);
            ++checked;
        }
    }
    CHECK(checked == 36);
}

/// How far a sampler with `steps` steps from Stable Diffusion's highest level to its lowest ends from the exact flow.
template <class Sample>
double error_of(Sample const& sample, std::size_t steps) {
    gaussian_denoiser const D;
    auto sigmas = karras_schedule<double>(steps + 1);
    sigmas.pop_back();
    double const z = sample(D, 15.0, sigmas);
    return std::abs(z - D.exact(15.0, sigmas.front(), sigmas.back()));
}

/// The order of convergence: how many halvings of the error a halving of the steps' length brings.
template <class Sample>
double order_of(Sample const& sample) {
    return std::log2(error_of(sample, 200) / error_of(sample, 400));
}

/// Checks that a sampler keeps nothing: a run is repeated to the bit, also when another run goes on inside of it.
template <class Sample>
void check_keeps_nothing(Sample const& sample) {
    gaussian_denoiser const D;
    two_cluster_denoiser const other_D;
    auto const sigmas = karras_schedule<double>(9);
    auto const other_sigmas = karras_schedule<double>(4, 0.1, 3.0);
    double const alone = sample(D, 11.0, sigmas);
    double const other_alone = sample(other_D, -2.0, other_sigmas);
    CHECK(alone != other_alone);
    CHECK(sample(D, 11.0, sigmas) == alone);

    std::size_t other_runs = 0;
    auto const interrupted = [&](double z, double sigma) {
        CHECK(sample(other_D, -2.0, other_sigmas) == other_alone);
        ++other_runs;
        return D(z, sigma);
    };
    CHECK(sample(interrupted, 11.0, sigmas) == alone);
    CHECK(other_runs >= 9);
}

} // namespace genrender
