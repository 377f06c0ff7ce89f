// SPDX-License-Identifier: MIT
// alpha of eq. 6 by step and site: the schedules that have a name.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/core/error.hpp>

#include <cstddef>
#include <functional>
#include <type_traits>
#include <utility>

namespace genrender {

/// alpha of eq. 6 by step, from 0, and site, as render_settings has it.
template <class Real>
using alpha_schedule = std::function<Real(std::size_t step, attention_site const& site)>;

/// The same alpha in every step, the paper's with paper_alpha.
template <class Real>
alpha_schedule<Real> constant_alpha(Real alpha) {
    return [alpha](std::size_t, attention_site const&) { return alpha; };
}

/// From `first` in the first of so many steps to `last` in the last, in a straight line; a single step has `first`. Fades
/// where `last` is below `first`, else rises.
template <class Real>
alpha_schedule<Real> running_alpha(Real first, std::type_identity_t<Real> last, std::size_t steps) {
    return [first, last, steps](std::size_t step, attention_site const&) {
        auto const share = steps > 1 ? static_cast<Real>(step) / static_cast<Real>(steps - 1) : Real{0};
        return first + share * (last - first);
    };
}

/// `alpha` in the first steps, those whose share step / steps is below `share`, and 0 in all others: they are left to
/// themselves by eq. 6, while a window of render_settings would also end eqs. 3 and 5. Throws value_error for a share
/// outside [0, 1].
template <class Real>
alpha_schedule<Real> early_alpha(Real alpha, std::type_identity_t<Real> share, std::size_t steps) {
    require_value(share >= 0 && share <= 1, "early_alpha", "share", share, "a share in [0, 1]");
    return [alpha, share, steps](std::size_t step, attention_site const&) {
        return static_cast<Real>(step) < share * static_cast<Real>(steps) ? alpha : Real{0};
    };
}

/// A schedule at sites of at least so many tokens, and 0 at coarser ones.
template <class Real>
alpha_schedule<Real> alpha_at_fine_sites(alpha_schedule<Real> schedule, std::size_t least_tokens) {
    return [schedule = std::move(schedule), least_tokens](std::size_t step, attention_site const& site) {
        return site.grid.size() >= least_tokens ? schedule(step, site) : Real{0};
    };
}

} // namespace genrender

#include <genrender/core/end_header.inl>
