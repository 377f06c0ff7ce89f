// SPDX-License-Identifier: MIT
// Whether an encoder finds the prompt of an image among others: classification without a classifier.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/evaluation/embeddings.hpp>

#include <cstddef>
#include <optional>
#include <string>

namespace genrender {

/// The text whose embedding lies closest in angle to that of an image, by its row of `texts` [texts, dimension]; the
/// first of equals. `image` [dimension]. Throws shape_error if dimensions differ, value_error without texts. [Radford
/// et al. 2021, sec. 3.1]
template <class Real>
std::size_t nearest_text(strided_view<Real, 1> image, in_view<std::remove_const_t<Real>, 2> texts) {
    require_shape("nearest_text", "texts", texts, {texts.extent(0), image.extent(0)});
    require_value(texts.extent(0) > 0, "nearest_text", "number of texts", texts.extent(0), "at least 1");
    std::size_t nearest = 0;
    auto greatest = cosine_similarity(image, texts[0]);
    for (std::size_t t = 1; t < texts.extent(0); ++t) {
        auto const similarity = cosine_similarity(image, texts[t]);
        if (similarity > greatest) {
            nearest = t;
            greatest = similarity;
        }
    }
    return nearest;
}

/// Share, in [0, 1], of the frames `embeddings` [frames, dimension] to which row `expected` of `texts` [texts,
/// dimension] is the nearest text; chance is 1 / texts. None without frames. Throws as nearest_text does, and
/// value_error unless `expected` is a row.
template <class Real>
std::optional<double> recognition(strided_view<Real, 2> embeddings, in_view<std::remove_const_t<Real>, 2> texts,
                                  std::size_t expected) {
    require_value(expected < texts.extent(0), "recognition", "expected", expected,
                  ("a row below " + std::to_string(texts.extent(0))).c_str());
    std::size_t recognised = 0;
    for (std::size_t i = 0; i < embeddings.extent(0); ++i) {
        recognised += nearest_text(embeddings[i], texts) == expected ? 1U : 0U;
    }
    auto const frames = static_cast<double>(embeddings.extent(0));
    return frames > 0 ? std::optional(static_cast<double>(recognised) / frames) : std::nullopt;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
