// SPDX-License-Identifier: MIT
// How often the surface point of a key is shown among the keys that a frame attends to: each point is to count once.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/sparse_rows.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace genrender {

/// What every key counts for, 1 / c with c the number of keys that show its point, where a frame joins the tokens of
/// `keyframes` keyframes to its own (eq. 5): its own tokens first and then theirs, (1 + keyframes) * tokens numbers.
/// log(1 / c) added to logits makes the c keys of a point weigh together like one key that is their mean. `rows` are the
/// frame's plan, whose entries of token t are the keyframe tokens that show its point, so c = 1 + their number; points
/// that the frame does not show count as often as keyframes show them. Of several own tokens that share a key the
/// greatest c holds for it.
template <class Real>
std::vector<float> point_counts(sparse_rows<Real> const& rows, std::size_t keyframes) {
    auto const tokens = rows.row_count();
    std::vector<float> counts((1 + keyframes) * tokens, 1.0F);
    for (std::size_t t = 0; t < tokens; ++t) {
        auto const count = 1 / static_cast<float>(1 + rows.offsets[t + 1] - rows.offsets[t]);
        counts[t] = count;
        for (auto e = rows.offsets[t]; e < rows.offsets[t + 1]; ++e) {
            auto& of_source = counts[tokens + rows.sources[e]];
            of_source = std::min(of_source, count);
        }
    }
    return counts;
}

/// The same for a keyframe that attends to all keyframes, itself among them (eq. 3): keyframes * tokens numbers, c the
/// number of the row's entries. A token that is not among the entries of its own row counts for one.
template <class Real>
std::vector<float> point_counts_of_stack(sparse_rows<Real> const& rows, std::size_t keyframes) {
    auto const tokens = rows.row_count();
    std::vector<float> counts(keyframes * tokens, 1.0F);
    for (std::size_t t = 0; t < tokens; ++t) {
        auto const seen = rows.offsets[t + 1] - rows.offsets[t];
        for (auto e = rows.offsets[t]; e < rows.offsets[t + 1]; ++e) {
            auto& of_source = counts[rows.sources[e]];
            of_source = std::min(of_source, 1 / static_cast<float>(seen));
        }
    }
    return counts;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
