// SPDX-License-Identifier: MIT
// [EDM eq. 5] The noise levels a sampler visits, dense where the noise is low.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

namespace genrender {

/// The `steps` + 1 noise levels of a run [EDM eq. 5]: sigma_i^(1/rho) falls linearly from sigma_max^(1/rho) to
/// sigma_min^(1/rho), i = 0 .. steps - 1, and sigma_steps = 0. The first level is sigma_max, the last but one
/// sigma_min, both to the bit; one step gives {sigma_max, 0}. The default range is that of Stable Diffusion's
/// training (discrete_noise_schedule). A run starts from latents of standard deviation sigma_max.
///
/// Throws value_error unless steps >= 1, sigma_min, sigma_max and rho are finite and above 0, and sigma_max is at
/// least sigma_min, above it for more than one step.
template <std::floating_point Real>
std::vector<Real> karras_schedule(std::size_t steps, Real sigma_min = Real(0.0292), Real sigma_max = Real(14.6146),
                                  Real rho = Real(7)) {
    auto const function = "karras_schedule";
    auto const positive = "a finite number above 0";
    require_value(steps >= 1, function, "steps", steps, "at least 1");
    require_value(is_finite(sigma_min) && sigma_min > 0, function, "sigma_min", sigma_min, positive);
    require_value(is_finite(sigma_max) && sigma_max > 0, function, "sigma_max", sigma_max, positive);
    require_value(is_finite(rho) && rho > 0, function, "rho", rho, positive);
    require_value(sigma_max >= sigma_min, function, "sigma_max", sigma_max, "at least sigma_min");
    require_value(steps == 1 || sigma_max > sigma_min, function, "sigma_max", sigma_max,
                  "above sigma_min for more than one step");

    // Double precision inside: the rho-th power multiplies the rounding error of a float by rho.
    auto const exponent = static_cast<double>(rho);
    auto const root_max = std::pow(static_cast<double>(sigma_max), 1 / exponent);
    auto const root_min = std::pow(static_cast<double>(sigma_min), 1 / exponent);
    std::vector<Real> sigmas(steps + 1, Real(0));
    sigmas[0] = sigma_max;
    for (std::size_t i = 1; i < steps; ++i) {
        auto const ramp = static_cast<double>(i) / static_cast<double>(steps - 1);
        auto const sigma = std::pow(root_max + ramp * (root_min - root_max), exponent);
        sigmas[i] = i + 1 < steps ? static_cast<Real>(sigma) : sigma_min;
    }
    return sigmas;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
