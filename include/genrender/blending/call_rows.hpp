// SPDX-License-Identifier: MIT
// The plans of all frames of a call as one list of int32 offsets and indices, as embedding bags take them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/padded_rows.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

namespace genrender {

/// Compressed rows of the frames of a call one after the other, row i * tokens + t for token t of frame i, in memory of
/// its own that may be written:
///     F_out[r] = own[r] * F_hat[r] + sum over e in [offsets[r], offsets[r + 1]) of weights[e] * F_KF[index[e]]
/// with F_hat read as [frames * tokens, channels] and F_KF as [keyframes * tokens, channels].
template <class Real>
struct call_rows {
    std::vector<std::int32_t> offsets{0}; ///< frames * tokens + 1 of them, rising from 0
    std::vector<std::int32_t> index;      ///< row of F_KF, one per entry
    std::vector<Real> weights;            ///< alpha times the plan's, one per entry
    std::vector<Real> own;                ///< 1 - alpha, or 1 where no keyframe covers the token; one per row
};

/// The rows of a call as `mix` is handed them, one plan a frame. Throws value_error if an int32 does not count sources or
/// entries, or alpha is not finite.
template <class Real>
call_rows<Real> make_call_rows(std::span<sparse_rows<Real> const> rows, std::type_identity_t<Real> alpha) {
    constexpr auto here = "make_call_rows";
    require_value(is_finite(alpha), here, "alpha", alpha, "a finite number");
    call_rows<Real> result;
    for (auto const& one : rows) {
        for (std::size_t t = 0; t < one.row_count(); ++t) {
            for (std::size_t e = one.offsets[t]; e < one.offsets[t + 1]; ++e) {
                result.index.push_back(detail::int32_row(here, one.sources[e]));
                result.weights.push_back(alpha * one.weights[e]);
            }
            require_value(result.index.size() <= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()),
                          here, "entries of rows", result.index.size(), "as many as an int32 counts");
            result.offsets.push_back(static_cast<std::int32_t>(result.index.size()));
            result.own.push_back(one.is_covered(t) ? 1 - alpha : Real{1});
        }
    }
    return result;
}

/// The same of a vector of rows, as feature_inputs has it.
template <class Real>
call_rows<Real> make_call_rows(std::vector<sparse_rows<Real>> const& rows, std::type_identity_t<Real> alpha) {
    return make_call_rows<Real>(std::span<sparse_rows<Real> const>(rows), alpha);
}

} // namespace genrender

#include <genrender/core/end_header.inl>
