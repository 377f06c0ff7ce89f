// SPDX-License-Identifier: MIT
// [EDM alg. 1] Euler's method: one evaluation a step, first order. Without its lines 6 to 8, which make it Heun's.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/sampling/latent_combination.hpp>
#include <genrender/sampling/sampler_arguments.hpp>
#include <genrender/sampling/sampler_history.hpp>

#include <concepts>
#include <cstddef>
#include <type_traits>

namespace genrender {

namespace detail {

/// `out`, which may be z, becomes euler_step(z, x0, sigma, sigma_next).
template <class Latents, std::floating_point Real>
void write_euler_step(Latents& out, Latents const& z, Latents const& x0, Real sigma, Real sigma_next) {
    auto const kept = sigma_next / sigma;
    combine_latents<Real>(out, {kept, 1 - kept}, z, x0);
}

} // namespace detail

/// Latents one step further: z + (sigma_next - sigma) d along d = (z - x0) / sigma [EDM alg. 1, lines 4 and 5],
/// gathered to (sigma_next / sigma) z + (1 - sigma_next / sigma) x0, so that sigma_next = 0 gives x0 to the bit.
/// Expects sigma > 0.
template <class Latents, std::floating_point Real>
Latents euler_step(Latents const& z, Latents const& x0, Real sigma, Real sigma_next) {
    auto next = z;
    detail::write_euler_step(next, z, x0, sigma, sigma_next);
    return next;
}

/// The latents at the last of the noise levels, from z at the first, following D by Euler's method; the deterministic
/// sampler of DDIM. D is evaluated once a step, steps being one fewer than levels.
///
/// `Latents` is any value type with Latents + Latents and Real * Latents: a scalar, xt::xtensor, Eigen::Array; or one of
/// viewed_latents and combined_latents. `after_step(step, z)` is called after each step, counted from 0, and may change z: what it leaves
/// there is what the next step starts from. Keeps nothing between calls but in `history`, from which it goes on. Throws as require_noise_levels does, and
/// what D and after_step throw.
template <class Denoise, class Latents, noise_levels Sigmas, class AfterStep = nothing_after_step>
    requires(clean_estimator<Denoise, Latents, level_type<Sigmas>>)
Latents euler(Denoise&& D, Latents z, Sigmas const& sigmas, AfterStep&& after_step = {},
              std::type_identity_t<sampler_history<Latents>>* history = nullptr) {
    require_noise_levels("euler", sigmas);
    for (auto i = detail::first_step("euler", history, std::size(sigmas)); i + 1 < std::size(sigmas); ++i) {
        Latents x0 = detail::estimate<Latents>(D, z, sigmas, i);
        detail::write_euler_step(z, z, x0, sigmas[i], sigmas[i + 1]);
        detail::note_step<Latents>(history, i, x0);
        after_step(i, z);
    }
    return z;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
