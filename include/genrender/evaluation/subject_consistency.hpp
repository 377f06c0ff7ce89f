// SPDX-License-Identifier: MIT
// How much each frame is like the first one and like the one before it, to an encoder of images: VBench's figure.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>
#include <genrender/evaluation/embeddings.hpp>

#include <cstddef>
#include <optional>

namespace genrender {

/// 1 / (T - 1) sum over t = 2 ... T of (cos(d_1, d_t) + cos(d_{t-1}, d_t)) / 2, in [-1, 1], where d_t is row t of
/// `embeddings` [frames, dimension]: VBench's subject consistency (Huang et al. 2024), which takes DINO for the encoder.
/// Unlike frame_consistency of interval 1 it sees what drifts away from the first frame. None with fewer than two frames.
template <class Real>
std::optional<double> subject_consistency(strided_view<Real, 2> embeddings) {
    if (embeddings.extent(0) < 2) {
        return std::nullopt;
    }
    double sum = 0;
    for (std::size_t t = 1; t < embeddings.extent(0); ++t) {
        sum +=
            (cosine_similarity(embeddings[0], embeddings[t]) + cosine_similarity(embeddings[t - 1], embeddings[t])) / 2;
    }
    return sum / static_cast<double>(embeddings.extent(0) - 1);
}

} // namespace genrender

#include <genrender/core/end_header.inl>
