// SPDX-License-Identifier: MIT
// [GR sec. 4: CLIP] The front door of encoders that put images and texts into one space.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>

#include <concepts>
#include <cstddef>
#include <string_view>
#include <vector>

namespace genrender {

/// Turns images and texts into vectors of one space, in which an image lies in the direction of the texts that describe
/// it. CLIP is one; what the metrics say is worth what the embedder has learnt.
///
/// expression                       | type                | meaning
/// ---------------------------------|---------------------|------------------------------------------------------------
/// `typename Embedder::real_type`   | float or double     | scalar of images and embeddings
/// `embedder.dimension()`           | size_t              | length of the vectors
/// `embedder.embed_image(image)`    | vector of real_type | of an image [channels, height, width] with values in
///                                  |                     | [0, 1], red first; resizing and normalising are the
///                                  |                     | embedder's own affair
/// `embedder.embed_text(text)`      | vector of real_type | of a text in UTF-8
///
/// These the compiler cannot check, and a model owes them (check_embedder_laws of testing/embedder_laws.hpp checks
/// them): vectors have `dimension()` finite elements and are not zero; equal arguments give equal vectors; the image is
/// not changed; calls may run at the same time on several threads if the caller uses more than one. Vectors need not
/// have length 1, and a text or a size that the embedder does not know may be refused with an exception.
/// See also: embed_frames; frame_consistency, prompt_fidelity and recognition, which are computed from its vectors.
template <class Embedder>
concept image_text_embedder = std::floating_point<typename Embedder::real_type> &&
    requires(Embedder const& embedder, strided_view<typename Embedder::real_type const, 3> image,
             std::string_view text) {
    { embedder.dimension() } -> std::convertible_to<std::size_t>;
    { embedder.embed_image(image) } -> std::same_as<std::vector<typename Embedder::real_type>>;
    { embedder.embed_text(text) } -> std::same_as<std::vector<typename Embedder::real_type>>;
};

/// The least that an image_text_embedder is, for checking what takes one; never run.
template <class Real>
struct image_text_embedder_archetype {
    using real_type = Real; ///< type of an embedding's numbers
    /// Length of an embedding.
    std::size_t dimension() const;
    /// Embedding of an image [channels, height, width].
    std::vector<Real> embed_image(strided_view<Real const, 3> image) const;
    /// Embedding of a text.
    std::vector<Real> embed_text(std::string_view text) const;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
