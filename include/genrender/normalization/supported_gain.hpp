// SPDX-License-Identifier: MIT
// The ratio of two measured deviations as far as their pixels support that it is not 1.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace genrender {

/// What a frame is multiplied by so that its deviation `from`, measured on `from_pixels`, becomes `to`, measured on
/// `to_pixels`: log g = log(to / from), moved towards 0 by `standard_errors` times
///     e = sqrt(1 / (2 (from_pixels - 1)) + 1 / (2 (to_pixels - 1))),
/// the standard error of that logarithm for independent normal values, and kept within [-log most_gain, log most_gain].
/// So 1 where deviations differ by no more than chance, and `most_gain` however flat a background is. Throws value_error
/// for deviations that are not above 0 or of fewer than 2 pixels.
template <class Real>
Real supported_gain(Real from, std::size_t from_pixels, std::type_identity_t<Real> to, std::size_t to_pixels,
                    std::type_identity_t<Real> standard_errors, std::type_identity_t<Real> most_gain) {
    require_value(from > 0, "supported_gain", "from", from, "a number above 0");
    require_value(to > 0, "supported_gain", "to", to, "a number above 0");
    require_value(from_pixels >= 2, "supported_gain", "from_pixels", from_pixels, "at least 2");
    require_value(to_pixels >= 2, "supported_gain", "to_pixels", to_pixels, "at least 2");
    auto const variance_of = [](std::size_t pixels) { return 1 / (2 * (static_cast<double>(pixels) - 1)); };
    auto const error = std::sqrt(variance_of(from_pixels) + variance_of(to_pixels));
    auto const logarithm = std::log(static_cast<double>(to) / static_cast<double>(from));
    auto const supported = std::max(0.0, std::abs(logarithm) - static_cast<double>(standard_errors) * error);
    auto const bounded = std::min(supported, std::log(static_cast<double>(most_gain)));
    return static_cast<Real>(std::exp(std::copysign(bounded, logarithm)));
}

} // namespace genrender

#include <genrender/core/end_header.inl>
