// SPDX-License-Identifier: MIT
// [GR eq. 3] Extended attention: every frame of a stack attends to the features of all of its frames.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>

#include <cstddef>

namespace genrender {

/// The sources of extended attention over `frames` frames: frame i attends to frames 0, 1, ... of K and V in their
/// order, which stands for K = W^K [f^1, ..., f^N] and V = W^V [f^1, ..., f^N] without joining them in memory. The
/// result points to K and V.
template <class Features>
attention_sources<Features> extended_attention_sources(Features const& K, Features const& V, std::size_t frames) {
    return attention_sources<Features>::stack(K, V, frames);
}

} // namespace genrender

#include <genrender/core/end_header.inl>
