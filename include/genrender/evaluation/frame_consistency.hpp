// SPDX-License-Identifier: MIT
// [GR sec. 4, table 1; supplement, table 2] How alike frames are to an encoder of images.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/evaluation/embeddings.hpp>

#include <cstddef>
#include <optional>

namespace genrender {

/// Mean cosine similarity between the embeddings of frames i and i + interval, over all i, in [-1, 1]; interval 1 is
/// the frame consistency of table 1, others are those of the supplement. `embeddings` [frames, dimension], see
/// embed_frames. None if the animation has no such pair. Throws value_error for an interval of 0.
template <class Real>
std::optional<double> frame_consistency(strided_view<Real, 2> embeddings, std::size_t interval = 1) {
    require_value(interval > 0, "frame_consistency", "interval", interval, "at least 1");
    if (interval >= embeddings.extent(0)) {
        return std::nullopt;
    }
    auto const pairs = embeddings.extent(0) - interval;
    double sum = 0;
    for (std::size_t i = 0; i < pairs; ++i) {
        sum += cosine_similarity(embeddings[i], embeddings[i + interval]);
    }
    return sum / static_cast<double>(pairs);
}

} // namespace genrender

#include <genrender/core/end_header.inl>
