// SPDX-License-Identifier: MIT
// [GR sec. 4: CLIP] The laws of image_text_embedder, as a check of a model.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/evaluation/image_text_embedder.hpp>
#include <genrender/testing/at_once.hpp>
#include <genrender/testing/law_report.hpp>
#include <genrender/testing/random_stack.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace genrender::testing {

namespace detail {

/// Notes a vector that has not `dimension` finite elements, or none but 0.
template <class Real>
void require_embedding(law_report& report, std::vector<Real> const& vector, std::size_t dimension,
                       std::string const& whose) {
    report.require(vector.size() == dimension, "image_text_embedder: vectors have dimension() elements",
                   std::to_string(vector.size()) + " of " + whose, std::to_string(dimension));
    report.require(std::all_of(vector.begin(), vector.end(), [](Real const& x) { return is_finite(x); }),
                   "image_text_embedder: vectors are finite", "an element of " + whose + " that is not",
                   "finite numbers");
    report.require(std::any_of(vector.begin(), vector.end(), [](Real x) { return x != 0; }),
                   "image_text_embedder: vectors are not zero", "zeros alone of " + whose, "a direction");
}

} // namespace detail

/// Checks the laws of image_text_embedder on two random images of `extents` [channels, height, width] and on `texts`,
/// both of which the embedder knows. Throws what the embedder throws.
template <image_text_embedder Embedder>
law_report check_embedder_laws(Embedder const& embedder, std::array<std::size_t, 3> const& extents,
                               std::span<std::string const> texts) {
    using Real = typename Embedder::real_type;
    law_report report;
    std::size_t const dimension = embedder.dimension();
    std::vector<stack<Real, 3>> images;
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
        images.push_back(random_stack<Real, 3>(extents, seed));
        std::for_each(images.back().data(), images.back().data() + images.back().size(),
                      [](Real& x) { x = std::clamp(Real(0.5) + x / 4, Real(0), Real(1)); });
    }
    auto const before = images;
    std::vector<std::vector<Real>> in_order;
    for (std::size_t i = 0; i < images.size(); ++i) {
        in_order.push_back(embedder.embed_image(images[i].view()));
        detail::require_embedding(report, in_order.back(), dimension, "image " + std::to_string(i));
    }
    for (auto const& text : texts) {
        auto const vector = embedder.embed_text(text);
        detail::require_embedding(report, vector, dimension, "text '" + text + "'");
        report.require(vector == embedder.embed_text(text), "image_text_embedder: equal texts give equal vectors",
                       "another vector of '" + text + "' when asked again", "the same");
    }
    for (std::size_t i = 0; i < images.size(); ++i) {
        detail::require_same(report, "image_text_embedder: the image is not changed",
                             "image " + std::to_string(i) + " ", images[i], before[i]);
    }
    // Backwards and on two threads, every vector is what it was.
    std::vector<char> same(images.size(), 0);
    at_once(2, images.size(), [&](std::size_t i) { same[i] = embedder.embed_image(images[i].view()) == in_order[i]; });
    for (std::size_t i = 0; i < images.size(); ++i) {
        report.require(same[i] != 0, "image_text_embedder: equal images give equal vectors, from any thread",
                       "another vector of image " + std::to_string(i) + " when asked again", "the same");
    }
    return report;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
