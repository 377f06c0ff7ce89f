// SPDX-License-Identifier: MIT
// [GR sec. 4] Embeddings of all frames and texts, computed once for every metric, and the cosine between two.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/evaluation/image_text_embedder.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

namespace genrender {

namespace detail {

/// Fills row i of a stack [count, dimension] with `embed(i)`. Throws shape_error if a vector has another length.
template <image_text_embedder Embedder, class Embed>
stack<typename Embedder::real_type, 2> embed_rows(Embedder const& embedder, std::size_t count, Embed const& embed,
                                                  any_loop const& loop) {
    std::size_t const dimension = embedder.dimension();
    stack<typename Embedder::real_type, 2> rows({count, dimension});
    loop(count, [&](std::size_t i) {
        auto const vector = embed(i);
        require_extents("embeddings", "vector", std::array{vector.size()}, std::array{dimension});
        std::copy(vector.begin(), vector.end(), rows.view()[i].data());
    });
    return rows;
}

} // namespace detail

/// The embedding of every frame of `images` [frames, channels, height, width], values in [0, 1]: [frames, dimension].
template <image_text_embedder Embedder>
stack<typename Embedder::real_type, 2>
embed_frames(Embedder const& embedder, in_view<typename Embedder::real_type, 4> images, any_loop const& loop = {}) {
    return detail::embed_rows(
        embedder, images.extent(0), [&](std::size_t i) { return embedder.embed_image(images[i]); }, loop);
}

/// The embedding of every text: [texts, dimension].
template <image_text_embedder Embedder>
stack<typename Embedder::real_type, 2> embed_texts(Embedder const& embedder, std::span<std::string const> texts) {
    return detail::embed_rows(
        embedder, texts.size(), [&](std::size_t i) { return embedder.embed_text(texts[i]); }, sequential_loop{});
}

/// Cosine of the angle between two vectors, in [-1, 1]; 0 if one of them is zero. Throws shape_error if their lengths
/// differ.
template <class Real>
double cosine_similarity(strided_view<Real, 1> a, in_view<std::remove_const_t<Real>, 1> b) {
    require_shape("cosine_similarity", "b", b, a.extents());
    double product = 0;
    double a_squared = 0;
    double b_squared = 0;
    for (std::size_t i = 0; i < a.extent(0); ++i) {
        auto const x = static_cast<double>(a(i));
        auto const y = static_cast<double>(b(i));
        product += x * y;
        a_squared += x * x;
        b_squared += y * y;
    }
    auto const lengths = std::sqrt(a_squared) * std::sqrt(b_squared);
    return lengths > 0 ? std::clamp(product / lengths, -1.0, 1.0) : 0.0;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
