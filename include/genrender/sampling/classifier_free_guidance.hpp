// SPDX-License-Identifier: MIT
// Classifier-free guidance (Ho and Salimans 2022, eq. 6): from the unconditional estimate past the conditional one, and
// what keeps its contrast (Lin et al. 2024, sec. 3.4).
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/linear_combination.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
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

namespace detail {

/// The standard deviation of all elements of a frame, 0 of fewer than 2.
template <class Real>
double deviation_of(strided_view<Real const, 3> const& frame) {
    double sum = 0;
    double squares = 0;
    auto const origin = frame.size() > 0 ? static_cast<double>(frame(0, 0, 0)) : 0.0;
    for (std::size_t c = 0; c < frame.extent(0); ++c) {
        for (std::size_t row = 0; row < frame.extent(1); ++row) {
            for (std::size_t column = 0; column < frame.extent(2); ++column) {
                auto const apart = static_cast<double>(frame(c, row, column)) - origin;
                sum += apart;
                squares += apart * apart;
            }
        }
    }
    auto const n = static_cast<double>(frame.size());
    return n < 2 ? 0.0 : std::sqrt(std::max(0.0, squares - sum * sum / n) / (n - 1));
}

} // namespace detail

/// Takes back what a large scale adds to contrast (Lin et al. 2024, eqs. 14 to 16): guided outputs F [frames, channels,
/// height, width] of a network become, frame by frame, (1 - share) F + share F deviation(F_cond) / deviation(F), with the
/// standard deviations of a frame's elements; .7 is what the paper takes. A frame without deviation stays. This is of
/// outputs, not of clean estimates, for which it would not come to the same. Throws shape_error unless F_cond has the
/// extents of F, value_error unless share is in [0, 1].
template <class Real>
void rescale_guidance(strided_view<Real, 4> F, in_view<Real, 4> F_cond, std::type_identity_t<Real> share) {
    require_shape("rescale_guidance", "F_cond", F_cond, F.extents());
    require_value(share >= 0 && share <= 1, "rescale_guidance", "share", share, "a number in [0, 1]");
    for (std::size_t i = 0; i < F.extent(0) && share > 0; ++i) {
        auto const of_guided = detail::deviation_of<Real>(strided_view<Real const, 4>(F)[i]);
        if (of_guided > 0) {
            auto const ratio = detail::deviation_of<Real>(F_cond[i]) / of_guided;
            auto const frame = F.slice(i, 1);
            linear_combination<Real, 4, 1>(frame, {1 - share + share * static_cast<Real>(ratio)},
                                           {strided_view<Real const, 4>(frame)});
        }
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
