// SPDX-License-Identifier: MIT
// [EDM alg. 1] The samplers by name, and what each costs.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/sampling/dpmpp_2m.hpp>
#include <genrender/sampling/euler.hpp>
#include <genrender/sampling/heun.hpp>
#include <genrender/sampling/sampler_arguments.hpp>
#include <genrender/sampling/sampler_history.hpp>

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>

namespace genrender {

/// A deterministic sampler.
enum class sampler_kind {
    euler,   ///< first order, one evaluation a step
    heun,    ///< second order, two evaluations a step
    dpmpp_2m ///< second order, one evaluation a step and the memory of another
};

/// The latents at the last of the noise levels, from z at the first, by the sampler of that name; see euler, heun and
/// dpmpp_2m. Throws as they do, and value_error for a value that names none.
template <class Denoise, class Latents, noise_levels Sigmas, class AfterStep = nothing_after_step>
    requires(clean_estimator<Denoise, Latents, level_type<Sigmas>>)
Latents sample(sampler_kind sampler, Denoise&& D, Latents z, Sigmas const& sigmas, AfterStep&& after_step = {},
               std::type_identity_t<sampler_history<Latents>>* history = nullptr) {
    switch (sampler) {
    case sampler_kind::euler:
        return euler(D, std::move(z), sigmas, after_step, history);
    case sampler_kind::heun:
        return heun(D, std::move(z), sigmas, after_step, history);
    case sampler_kind::dpmpp_2m:
        return dpmpp_2m(D, std::move(z), sigmas, after_step, history);
    }
    throw value_error("sample: sampler is " + std::to_string(static_cast<int>(sampler)) +
                      ", expected euler, heun or dpmpp_2m");
}

/// Whether a sampler goes on from its last clean estimate (sampler_history::x0_last), not from z alone.
constexpr bool remembers_estimates(sampler_kind sampler) { return sampler == sampler_kind::dpmpp_2m; }

/// How often a run evaluates D at its noise level i, counted from 0, above level 0. Throws value_error for a value that
/// names no sampler.
inline std::size_t evaluations_at(sampler_kind sampler, std::size_t i) {
    switch (sampler) {
    case sampler_kind::euler:
    case sampler_kind::dpmpp_2m:
        return 1;
    case sampler_kind::heun: // The step before ends where this one begins.
        return i == 0 ? 1 : 2;
    }
    throw value_error("evaluations: sampler is " + std::to_string(static_cast<int>(sampler)) +
                      ", expected euler, heun or dpmpp_2m");
}

/// How often a run of `steps` steps that ends at level 0, such as karras_schedule(steps), evaluates D. Throws
/// value_error for 0 steps or a value that names no sampler.
inline std::size_t evaluations(sampler_kind sampler, std::size_t steps) {
    require_value(steps >= 1, "evaluations", "steps", steps, "at least 1");
    std::size_t count = 0;
    for (std::size_t i = 0; i < steps; ++i) {
        count += evaluations_at(sampler, i);
    }
    return count;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
