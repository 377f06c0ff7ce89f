// SPDX-License-Identifier: MIT
// [GR alg. 1: the loop] A sampler that takes the latents of a run from noise to the end, where they lie.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/pipeline/checkpoint.hpp>
#include <genrender/pipeline/progress.hpp>
#include <genrender/sampling/latent_lender.hpp>
#include <genrender/sampling/lent_latents.hpp>
#include <genrender/sampling/sampler.hpp>
#include <genrender/sampling/sampler_history.hpp>

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
                    std::function<void(std::size_t, latents<Real>&)> const& after_step,
                    sampler_history<latents<Real>>* history) {
    sample(sampler, D, z, sigmas, after_step, history);
}

GENRENDER_INSTANCE(sample_latents<float>);
GENRENDER_INSTANCE(sample_latents<double>);

} // namespace detail

/// Told of a step that is done: its number, from 0, and functions that read z and the last clean
/// estimate, in host memory.
template <class Real>
using step_observer = std::function<void(std::size_t step, std::function<latents<Real>()> const& z,
                                         std::function<latents<Real>()> const& x0)>;

/// Replaces z, at the first noise level or as `resume` has left it, by the latents after the last whole step. Returns
/// whether the observer of progress ended the run. Latents that are lent are uploaded once and downloaded once, and when
/// `told` reads them; without `told` and `resume` nothing is kept for either.
template <class Real, class Phi, class Denoise>
bool run_sampler(Phi const& phi, Denoise const& D, latents<Real>& z, std::vector<Real> const& sigmas,
                 sampler_kind sampler, step_observer<Real> const& told = {}, checkpoint<Real> const* resume = nullptr) {
    bool is_cancelled = false;
    // `last` is z, `load` makes such latents of those in host memory and `read` the reverse.
    auto const follow = [&]<class Latents>(Latents& last, auto const& load, auto const& read, auto const& run) {
        sampler_history<Latents> history;
        if (resume != nullptr) {
            history.steps = resume->steps;
            if (resume->x0_last) {
                history.x0_last.emplace(load(*resume->x0_last));
            }
        }
        auto const keeps_history = told || resume != nullptr;
        try {
            run(
                [&](std::size_t step, Latents& now) {
                    D.after_step(step, now);
                    last = now;
                    if (told) {
                        told(
                            step, [&] { return read(last); }, [&] { return read(*history.x0_last); });
                    }
                },
                keeps_history ? &history : nullptr);
        } catch (cancelled const&) {
            is_cancelled = true;
        }
    };
    if constexpr (latent_lender<Phi>) {
        lent_latents<Phi> last(phi, to_view(std::as_const(z)));
        follow(
            last, [&](latents<Real> const& from) { return lent_latents<Phi>(phi, to_view(from)); },
            [&](lent_latents<Phi> const& from) {
                auto to = latents<Real>::from_shape(z.shape());
                from.download(to_view(to));
                return to;
            },
            [&](auto const& after_step, auto* history) { sample(sampler, D, last, sigmas, after_step, history); });
        last.download(to_view(z));
    } else {
        auto const same = [](latents<Real> const& from) { return from; };
        follow(z, same, same, [&](auto const& after_step, auto* history) {
            detail::sample_latents<Real>(sampler, std::cref(D), z, sigmas, after_step, history);
        });
    }
    return is_cancelled;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
