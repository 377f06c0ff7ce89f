// SPDX-License-Identifier: MIT
// [DPM++ alg. 2] DPM-Solver++(2M) (Lu et al. 2022): one evaluation a step, second order by remembering the last one.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/sampling/euler.hpp>
#include <genrender/sampling/latent_combination.hpp>
#include <genrender/sampling/sampler_arguments.hpp>
#include <genrender/sampling/sampler_history.hpp>

#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace genrender {

namespace detail {

/// z becomes the Euler step towards x0 + further (x0 - x0_last).
template <class Latents, std::floating_point Real>
void take_extrapolated_step(Latents& z, Latents const& x0, Latents const& x0_last, Real further, Real sigma,
                            Real sigma_next) {
    auto const kept = sigma_next / sigma;
    auto const added = 1 - kept;
    combine_latents<Real>(z, {kept, added * (1 + further), -added * further}, z, x0, x0_last);
}

} // namespace detail

/// The latents at the last of the noise levels, from z at the first, following D by DPM-Solver++(2M). D is evaluated
/// once a step. The first step and a step to level 0 are of first order: the one has no past, the other is infinitely
/// long in log sigma.
///
/// What `Latents` and `after_step` are, what is kept and what is thrown: see euler.
template <class Denoise, class Latents, noise_levels Sigmas, class AfterStep = nothing_after_step>
    requires(clean_estimator<Denoise, Latents, level_type<Sigmas>>)
Latents dpmpp_2m(Denoise&& D, Latents z, Sigmas const& sigmas, AfterStep&& after_step = {},
                 std::type_identity_t<sampler_history<Latents>>* history = nullptr) {
    using Real = level_type<Sigmas>;
    require_noise_levels("dpmpp_2m", sigmas);
    // The last clean estimate lives here and dies with the call, unless the caller holds it.
    sampler_history<Latents> own;
    auto* const past = history != nullptr ? history : &own;
    for (auto i = detail::first_step("dpmpp_2m", past, std::size(sigmas)); i + 1 < std::size(sigmas); ++i) {
        Real const sigma = sigmas[i];
        Real const sigma_next = sigmas[i + 1];
        Latents x0 = detail::estimate<Latents>(D, z, sigmas, i);
        // The step of alg. 2, (sigma_next / sigma) z - (exp(-h) - 1) x0 with h = log(sigma / sigma_next), is
        // Euler's: what makes it second order is that the clean estimate is extrapolated in log sigma to the
        // middle of the step.
        if (i > 0 && past->x0_last && sigma_next > 0) {
            auto const h_last = std::log(sigmas[i - 1] / sigma);
            auto const h = std::log(sigma / sigma_next);
            detail::take_extrapolated_step(z, x0, *past->x0_last, h / (2 * h_last), sigma, sigma_next);
        } else {
            detail::write_euler_step(z, z, x0, sigma, sigma_next);
        }
        detail::note_step<Latents>(past, i, x0);
        after_step(i, z);
    }
    return z;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
