// SPDX-License-Identifier: MIT
// Which plan rows are of: equal keys mean equal arrays, so that a device uploads each plan once.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>

#include <atomic>
#include <compare>
#include <cstdint>

namespace genrender {

/// What tells plans apart. Rows with equal keys hold the same values at every site of the grid and in every guidance
/// branch, for as long as the program runs. Evaluations of a run follow each other: once a key of a later evaluation is
/// seen, none of an earlier one of that run comes again, and what was uploaded for it can be dropped.
struct plan_key {
    grid_extents grid;            ///< the feature grid that the plan is for
    frame_index frame;            ///< the frame that it is for
    std::uint64_t evaluation = 0; ///< number of the pass over the animation, as next_evaluation gave it
    /// Orders by grid, frame and evaluation.
    friend constexpr auto operator<=>(plan_key, plan_key) = default;
};

/// A number from 1 that no other call in this program has got, of this run or another. For those who make plans: one
/// number for all plans of a pass. May be called from several threads at once.
inline std::uint64_t next_evaluation() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
