// SPDX-License-Identifier: MIT
// A sparse linear map between token rows as three plain arrays, which an engine can hand to its own gather operation.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/plan_key.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace genrender {

/// For every row of the result, a short weighted sum of source rows (compressed sparse rows):
///     result[r] = sum over e in [offsets[r], offsets[r + 1]) of weights[e] * source[sources[e]].
/// A row without entries is not covered: the result there is the reader's own.
template <class Real>
struct sparse_rows {
    std::span<std::uint32_t const> offsets; ///< rows + 1 of them, rising from 0
    std::span<std::uint32_t const> sources; ///< number of the source row, one per entry
    std::span<Real const> weights;          ///< one per entry
    /// What rows that `render` hands over are told apart by: equal keys mean equal arrays. None for rows of nobody's
    /// plan.
    std::optional<plan_key> key{};

    /// Number of rows, covered or not.
    std::size_t row_count() const { return offsets.empty() ? 0 : offsets.size() - 1; }
    /// Whether a row has entries. `row` < row_count().
    bool is_covered(std::size_t row) const { return offsets[row] < offsets[row + 1]; }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
