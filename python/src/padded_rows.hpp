// SPDX-License-Identifier: MIT
// [GR eq. 6] Blend plans at a fixed width: what a device gathers without asking how long a row is.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/sparse_rows.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace genrender::python {

/// F_out = own F_hat + sum over w of weights[w] F_KF[index[w]], which is eq. 6 with alpha folded in.
template <class Real>
struct padded_rows {
    std::size_t width = 0; ///< W, entries of every row
    std::vector<std::int32_t>
        index;                 ///< keyframe * tokens + token [frames, tokens, W]; 0 where a row has no more entries
    std::vector<Real> weights; ///< alpha times the plan's [frames, tokens, W]; 0 where a row has no more entries
    std::vector<Real> own;     ///< 1 - alpha, or 1 where no keyframe covers the token [frames, tokens]
};

/// The rows of several frames, all of as many tokens, `width` entries each; without a width as many as the longest row
/// has. Throws value_error if a row is longer, alpha is not finite or a source has no place in 32 bits.
template <class Real>
padded_rows<Real> make_padded_rows(std::span<sparse_rows<Real> const> frames, std::type_identity_t<Real> alpha,
                                   std::optional<std::size_t> width = std::nullopt) {
    constexpr auto here = "make_padded_rows";
    require_value(is_finite(alpha), here, "alpha", alpha, "a finite number");
    std::size_t rows = 0;
    std::size_t longest = 0;
    for (auto const& frame : frames) {
        rows += frame.row_count();
        for (std::size_t row = 0; row < frame.row_count(); ++row) {
            longest = std::max<std::size_t>(longest, frame.offsets[row + 1] - frame.offsets[row]);
        }
    }
    padded_rows<Real> result;
    result.width = width.value_or(longest);
    require_value(longest <= result.width, here, "width", result.width,
                  ("at least the " + std::to_string(longest) + " entries of the longest row").c_str());
    result.index.assign(rows * result.width, 0);
    result.weights.assign(rows * result.width, Real(0));
    result.own.assign(rows, Real(1));
    std::size_t at = 0;
    for (auto const& frame : frames) {
        for (std::size_t row = 0; row < frame.row_count(); ++row, ++at) {
            auto place = at * result.width;
            for (auto e = frame.offsets[row]; e < frame.offsets[row + 1]; ++e, ++place) {
                require_value(frame.sources[e] <= std::uint32_t{std::numeric_limits<std::int32_t>::max()}, here,
                              "source", frame.sources[e], "a number of 31 bits");
                result.index[place] = static_cast<std::int32_t>(frame.sources[e]);
                result.weights[place] = alpha * frame.weights[e];
            }
            if (frame.is_covered(row)) {
                result.own[at] = 1 - alpha;
            }
        }
    }
    return result;
}

} // namespace genrender::python
