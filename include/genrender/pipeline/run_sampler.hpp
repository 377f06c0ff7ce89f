// SPDX-License-Identifier: MIT
// [GR alg. 1: the loop] A sampler that takes the latents of a run from noise to the end, where they lie.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/pipeline/progress.hpp>
#include <genrender/sampling/latent_lender.hpp>
#include <genrender/sampling/lent_latents.hpp>
#include <genrender/sampling/sampler.hpp>

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace genrender {

namespace detail {

/// Samples from z by an erased D: samplers are compiled once for all networks, maps and methods.
template <class Real>
void sample_latents(sampler_kind sampler,
                    std::function<latents<Real>(latents<Real> const&, Real, std::size_t)> const& D,
                    latents<Real> const& z, std::vector<Real> const& sigmas,
                    std::function<void(std::size_t, latents<Real>&)> const& after_step) {
    sample(sampler, D, z, sigmas, after_step);
}

GENRENDER_INSTANCE(sample_latents<float>);
GENRENDER_INSTANCE(sample_latents<double>);

} // namespace detail

/// Replaces z, at the first noise level, by the latents after the last whole step. Returns whether the observer ended the
/// run. Latents that are lent are uploaded once and downloaded once.
template <class Real, class Phi, class Denoise>
bool run_sampler(Phi const& phi, Denoise const& D, latents<Real>& z, std::vector<Real> const& sigmas,
                 sampler_kind sampler) {
    bool is_cancelled = false;
    auto const follow = [&](auto& last, auto const& run) {
        try {
            run([&](std::size_t step, auto& now) {
                D.after_step(step, now);
                last = now;
            });
        } catch (cancelled const&) {
            is_cancelled = true;
        }
    };
    if constexpr (latent_lender<Phi>) {
        lent_latents<Phi> last(phi, to_view(std::as_const(z)));
        follow(last, [&](auto const& after_step) { sample(sampler, D, last, sigmas, after_step); });
        last.download(to_view(z));
    } else {
        follow(z, [&](auto const& after_step) {
            detail::sample_latents<Real>(sampler, std::cref(D), z, sigmas, after_step);
        });
    }
    return is_cancelled;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
