// SPDX-License-Identifier: MIT
// [GR sec. 4, table 1] How well frames fit their prompt to an encoder of images and texts.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/evaluation/embeddings.hpp>

#include <cstddef>
#include <optional>

namespace genrender {

/// Mean cosine similarity between the embedding of each frame and that of the prompt, in [-1, 1]. `embeddings` [frames,
/// dimension], see embed_frames; `prompt` [dimension]. None without frames. Throws shape_error if dimensions differ.
template <class Real>
std::optional<double> prompt_fidelity(strided_view<Real, 2> embeddings, in_view<std::remove_const_t<Real>, 1> prompt) {
    require_shape("prompt_fidelity", "prompt", prompt, {embeddings.extent(1)});
    double sum = 0;
    for (std::size_t i = 0; i < embeddings.extent(0); ++i) {
        sum += cosine_similarity(embeddings[i], prompt);
    }
    return embeddings.extent(0) > 0 ? std::optional(sum / static_cast<double>(embeddings.extent(0))) : std::nullopt;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
