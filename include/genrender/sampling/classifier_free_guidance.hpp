// SPDX-License-Identifier: MIT
// Classifier-free guidance (Ho and Salimans 2022, eq. 6): from the unconditional estimate past the conditional one.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/linear_combination.hpp>
#include <genrender/core/strided_view.hpp>

#include <type_traits>

// A guided network runs once a guidance branch. Branch 0 is the unconditional one (the empty or the negative prompt),
// branch 1 the conditional one, wherever the library counts branches.

namespace genrender {

/// The guided clean estimate: out = x0_uncond + scale (x0_cond - x0_uncond), all [frames, channels, height, width]. A
/// scale of 0 is the unconditional estimate, 1 the conditional one, 7.5 usual with Stable Diffusion (1 + w in the
/// letters of the paper). As [EDM eq. 7] is linear in the network's output, guiding clean estimates and guiding
/// outputs come to the same. `out` may be either input itself. Throws shape_error unless both inputs have the extents
/// of out, value_error unless scale is finite.
template <class Real>
void guide(strided_view<Real, 4> out, in_view<Real, 4> x0_uncond, in_view<Real, 4> x0_cond,
           std::type_identity_t<Real> scale) {
    require_shape("guide", "x0_uncond", x0_uncond, out.extents());
    require_shape("guide", "x0_cond", x0_cond, out.extents());
    require_value(is_finite(scale), "guide", "scale", scale, "a finite number");
    linear_combination<Real, 4, 2>(out, {1 - scale, scale}, {x0_uncond, x0_cond});
}

} // namespace genrender

#include <genrender/core/end_header.inl>
