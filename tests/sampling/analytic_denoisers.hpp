// SPDX-License-Identifier: MIT
// Clean estimates known in closed form, for samplers to follow.
#pragma once

#include "golden.hpp"

#include <cmath>
#include <cstddef>

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

} // namespace genrender
