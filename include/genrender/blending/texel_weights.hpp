// SPDX-License-Identifier: MIT
// [GR sec. 3.2] How a texel mixes the keyframes that see it: average, first fill, and the mean of both.
#pragma once

#include <genrender/core/begin_header.inl>

#include <cstddef>

namespace genrender {

/// Share of each of `seen` > 0 keyframes that see a texel in the average texture: 1 / seen. Keyframes that do not see
/// it take no part in the division.
template <class Real>
constexpr Real average_weight(std::size_t seen) {
    return 1 / static_cast<Real>(seen);
}

/// Share of a keyframe in an average by quality, quality / sum over the keyframes that see the texel; alike where
/// nothing is known of any of them.
template <class Real>
constexpr Real average_weight_by_quality(double quality, double sum, std::size_t seen) {
    return sum > 0 ? static_cast<Real>(quality / sum) : average_weight<Real>(seen);
}

/// Share in the inpainted texture, which is filled in the drawn order and only where it has not been filled before:
/// all for the first keyframe that sees the texel (position 0 among those that do), nothing for the others. Being
/// filled is known from geometry, never read off a value.
template <class Real>
constexpr Real first_fill_weight(std::size_t position) {
    return position == 0 ? Real{1} : Real{0};
}

/// Share in the unified texture: first_fill_share of the inpainted texture and the rest of the average texture, in
/// which the keyframe has the share `average`; the paper's texture is the mean of both, first_fill_share = 1/2.
template <class Real>
constexpr Real unified_weight(std::size_t position, Real average, Real first_fill_share) {
    return first_fill_share * first_fill_weight<Real>(position) + (1 - first_fill_share) * average;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
