// SPDX-License-Identifier: MIT
// What a sampler goes on from besides its latents, held by the caller: where a run was left, and where it is.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

namespace genrender {

/// The past of latents under way. A sampler that is given one begins after `steps` steps, with z as these left it, and
/// keeps it up to date before each call of after_step; the latents at the end are those of a run in one go, to the bit.
template <class Latents>
struct sampler_history {
    std::size_t steps = 0; ///< that are done, counted from the first noise level
    /// The clean estimate of the last evaluation in the last step; none before the first. dpmpp_2m alone goes on from it,
    /// and without it begins anew with a step of first order; the others write it alone.
    std::optional<Latents> x0_last{};
};

namespace detail {

/// The step that a sampler begins with. Throws value_error for a past of more steps than there are.
template <class Latents>
std::size_t first_step(char const* function, sampler_history<Latents> const* history, std::size_t levels) {
    auto const steps = history != nullptr ? history->steps : std::size_t{0};
    require_value(steps < levels, function, "history.steps", steps,
                  ("at most " + std::to_string(levels - 1) + ", one less than there are noise levels").c_str());
    return steps;
}

/// Step i is done, and x0 was its last estimate.
template <class Latents>
void note_step(sampler_history<Latents>* history, std::size_t i, Latents& x0) {
    if (history != nullptr) {
        history->steps = i + 1;
        history->x0_last = std::move(x0);
    }
}

} // namespace detail

} // namespace genrender

#include <genrender/core/end_header.inl>
