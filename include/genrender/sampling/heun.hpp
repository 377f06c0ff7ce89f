// SPDX-License-Identifier: MIT
// [EDM alg. 1] Heun's method: two evaluations a step, second order.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/sampling/euler.hpp>
#include <genrender/sampling/latent_combination.hpp>
#include <genrender/sampling/sampler_arguments.hpp>
#include <genrender/sampling/sampler_history.hpp>

#include <cstddef>
#include <type_traits>

namespace genrender {

namespace detail {

/// z becomes z + (sigma_next - sigma) (d + d_next) / 2 with the slopes d = (z - x0) / sigma here and d_next = (z_euler
/// - x0_next) / sigma_next there.
template <class Latents, std::floating_point Real>
void take_mean_step(Latents& z, Latents const& x0, Latents const& z_euler, Latents const& x0_next, Real sigma,
                    Real sigma_next) {
    auto const half = (sigma_next - sigma) / 2;
    auto const here = half / sigma;
    auto const there = half / sigma_next;
    combine_latents<Real>(z, {1 + here, -here, there, -there}, z, x0, z_euler, x0_next);
}

} // namespace detail

/// The latents at the last of the noise levels, from z at the first, following D by Heun's method: an Euler step,
/// then the same step again along the mean of the slopes at both of its ends. D is evaluated twice a step, the second
/// time at the step's lower level; but once in a step to level 0, where the slope (z - x0) / sigma has no value.
///
/// What `Latents` and `after_step` are, what is kept and what is thrown: see euler.
template <class Denoise, class Latents, noise_levels Sigmas, class AfterStep = nothing_after_step>
    requires(clean_estimator<Denoise, Latents, level_type<Sigmas>>)
Latents heun(Denoise&& D, Latents z, Sigmas const& sigmas, AfterStep&& after_step = {},
             std::type_identity_t<sampler_history<Latents>>* history = nullptr) {
    using Real = level_type<Sigmas>;
    require_noise_levels("heun", sigmas);
    Latents z_euler = z;
    for (auto i = detail::first_step("heun", history, std::size(sigmas)); i + 1 < std::size(sigmas); ++i) {
        Real const sigma = sigmas[i];
        Real const sigma_next = sigmas[i + 1];
        Latents x0 = detail::estimate<Latents>(D, z, sigmas, i);
        if (sigma_next > 0) {
            detail::write_euler_step(z_euler, z, x0, sigma, sigma_next);
            Latents x0_next = detail::estimate<Latents>(D, z_euler, sigmas, i + 1);
            detail::take_mean_step(z, x0, z_euler, x0_next, sigma, sigma_next);
            detail::note_step<Latents>(history, i, x0_next);
        } else {
            detail::write_euler_step(z, z, x0, sigma, sigma_next);
            detail::note_step<Latents>(history, i, x0);
        }
        after_step(i, z);
    }
    return z;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
