// SPDX-License-Identifier: MIT
// [EDM eq. 7] From what a raw network predicts to the clean estimate D(z, sigma) = c_skip z + c_out F(c_in z, t).
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/linear_combination.hpp>
#include <genrender/core/strided_view.hpp>

#include <cmath>
#include <concepts>
#include <string>
#include <type_traits>

// Everywhere in the library z = x0 + sigma n, with clean latents x0 and n of N(0, 1). Networks were trained on other
// mixtures of the same x0 and n, which are z times a factor c_in that depends on sigma alone:
//
//     variance preserving  z_t = a x0 + b n,        a^2 + b^2 = 1, b / a = sigma   so  a = 1 / sqrt(1 + sigma^2) = c_in
//     rectified flow       z_t = (1 - t) x0 + t n,  t / (1 - t) = sigma            so  1 - t = 1 / (1 + sigma) = c_in
//
// Solving what the network predicts for x0 gives c_skip and c_out:
//
//     epsilon    F = n             x0 = z - sigma F
//     velocity   F = a n - b x0    a z_t - b F = (a^2 + b^2) x0    so  x0 = a^2 z - b F
//     clean      F = x0            x0 = F
//     flow       F = n - x0        z_t - t F = x0                  so  x0 = (1 - t) z - t F

namespace genrender {

/// What a network's output F stands for, and by that the mixture it takes as input.
enum class prediction {
    epsilon,  ///< the noise n (Ho et al. 2020): Stable Diffusion 1.x, 2.x-base, SDXL
    velocity, ///< a n - b x0 (Salimans and Ho 2022, app. D): Stable Diffusion 2.x at 768
    clean,    ///< the clean latents x0
    flow      ///< n - x0, the velocity of a rectified flow (Liu et al. 2022): Stable Diffusion 3 and Flux
};

/// The factors of [EDM eq. 7] at one noise level.
template <std::floating_point Real>
struct scalings {
    Real c_skip = 0; ///< of the noisy latents z
    Real c_out = 0;  ///< of the network's output F
    Real c_in = 1;   ///< of z on its way into the network
};

/// The factors at noise level sigma. `prediction::epsilon` gives the column 'VP' of [EDM table 1]; `velocity` is, up
/// to the sign of F, EDM's own column at sigma_data = 1. The networks' time goes with them:
/// discrete_noise_schedule::t_of(sigma), and flow_time_of(sigma) for `flow`. Throws value_error unless sigma is
/// finite and at least 0.
template <std::floating_point Real>
scalings<Real> scalings_of(prediction predicted, Real sigma) {
    require_value(is_finite(sigma) && sigma >= 0, "scalings_of", "sigma", sigma, "a finite number of at least 0");
    auto const a = 1 / std::hypot(Real(1), sigma);
    switch (predicted) {
    case prediction::epsilon:
        return {Real(1), -sigma, a};
    case prediction::velocity:
        return {a * a, -sigma * a, a};
    case prediction::clean:
        return {Real(0), Real(1), a};
    case prediction::flow:
        return {1 / (1 + sigma), -sigma / (1 + sigma), 1 / (1 + sigma)};
    }
    throw value_error("scalings_of: predicted is " + std::to_string(static_cast<int>(predicted)) +
                      ", expected epsilon, velocity, clean or flow");
}

/// The time t = sigma / (1 + sigma) of a rectified flow at noise level sigma, in [0, 1): sigma = t / (1 - t), t = 1
/// being pure noise. Throws value_error unless sigma is finite and at least 0.
template <std::floating_point Real>
Real flow_time_of(Real sigma) {
    require_value(is_finite(sigma) && sigma >= 0, "flow_time_of", "sigma", sigma, "a finite number of at least 0");
    return sigma / (1 + sigma);
}

/// The clean estimate [EDM eq. 7]: out = c_skip z + c_out F, all [frames, channels, height, width], where F is the
/// network's output for c_in z. `out` may be z or F itself. Throws shape_error unless z and F have the extents of
/// out, value_error unless sigma is finite and at least 0.
template <class Real>
void to_clean(strided_view<Real, 4> out, prediction predicted, in_view<Real, 4> z, in_view<Real, 4> F,
              std::type_identity_t<Real> sigma) {
    require_shape("to_clean", "z", z, out.extents());
    require_shape("to_clean", "F", F, out.extents());
    auto const factors = scalings_of(predicted, sigma);
    linear_combination<Real, 4, 2>(out, {factors.c_skip, factors.c_out}, {z, F});
}

} // namespace genrender

#include <genrender/core/end_header.inl>
