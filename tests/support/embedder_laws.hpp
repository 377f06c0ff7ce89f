// SPDX-License-Identifier: MIT
// What every image_text_embedder owes beyond its concept, as checks for models of the library and of users.
#pragma once

#include "random_stack.hpp"

#include <genrender/core/parallel.hpp>
#include <genrender/evaluation/image_text_embedder.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace genrender::testing {

/// Whether a vector has `dimension` finite elements, not all of them 0.
template <class Real>
bool is_embedding(std::vector<Real> const& vector, std::size_t dimension) {
    return vector.size() == dimension &&
           std::all_of(vector.begin(), vector.end(), [](Real x) { return std::isfinite(x); }) &&
           std::any_of(vector.begin(), vector.end(), [](Real x) { return x != 0; });
}

/// Checks the laws of image_text_embedder on two random images of `extents` [channels, height, width] and on `texts`
/// that the embedder knows.
template <image_text_embedder Embedder>
void check_embedder_laws(Embedder const& embedder, std::array<std::size_t, 3> const& extents,
                         std::span<std::string const> texts) {
    using Real = typename Embedder::real_type;
    std::size_t const dimension = embedder.dimension();
    std::vector<stack<Real, 3>> images;
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
        images.push_back(random_stack<Real, 3>(extents, seed));
        std::for_each(images.back().data(), images.back().data() + images.back().size(),
                      [](Real& x) { x = std::clamp(Real(0.5) + x / 4, Real(0), Real(1)); });
    }
    auto const before = images;
    std::vector<std::vector<Real>> in_order;
    for (auto const& image : images) {
        in_order.push_back(embedder.embed_image(image.view()));
        REQUIRE(is_embedding(in_order.back(), dimension));
    }
    for (auto const& text : texts) {
        auto const vector = embedder.embed_text(text);
        REQUIRE(is_embedding(vector, dimension));
        REQUIRE(vector == embedder.embed_text(text));
    }
    for (std::size_t i = 0; i < images.size(); ++i) {
        REQUIRE(std::equal(images[i].data(), images[i].data() + images[i].size(), before[i].data()));
    }
    // Backwards and on two threads, every vector is what it was.
    std::vector<char> same(images.size(), 0);
    threaded_loop{2}(images.size(), [&](std::size_t i) {
        auto const image = images.size() - 1 - i;
        same[image] = embedder.embed_image(images[image].view()) == in_order[image];
    });
    for (auto const image_is_same : same) {
        REQUIRE(image_is_same);
    }
}

} // namespace genrender::testing
