// SPDX-License-Identifier: MIT
// The stand-in for an image autoencoder: one level of the orthonormal Haar transform (Haar 1910).
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>

#include <array>
#include <cstddef>

// A square of four pixels a b / c d has the mean band (a + b + c + d) / 2, and three details: left minus right, top
// minus bottom and the diagonals' difference, each over 2. Images lie in [0, 1] and enter as 2 x - 1; bands leave
// scaled so that pictures of lit scenes come near unit variance, as a denoiser expects of its latents.

namespace genrender::reference {

/// Bands of the transform.
enum class haar_band : std::size_t {
    mean,       ///< half the sum of a square of 2 x 2 pixels
    left_right, ///< half of its left pixels less its right ones
    top_bottom, ///< half of its upper pixels less its lower ones
    diagonal    ///< half of its upper left and lower right pixels less the other two
};

namespace internal {

/// latent = scale * (band + shift).
struct haar_scaling {
    double scale;
    double shift;
};

inline constexpr std::array<haar_scaling, 4> haar_scalings{{{1.05, -0.38}, {4.5, 0}, {4.5, 0}, {4.5, 0}}};

/// The transform of one square, which is its own inverse.
template <class Real>
std::array<Real, 4> haar_square(Real a, Real b, Real c, Real d) {
    return {(a + b + c + d) / 2, (a - b + c - d) / 2, (a + b - c - d) / 2, (a - b - c + d) / 2};
}

} // namespace internal

/// Writes the latents [4 colours, height / 2, width / 2] of an image [colours, height, width] in [0, 1]; channel
/// band * colours + colour. Throws value_error for odd extents, shape_error if the latents do not fit.
template <class Real>
void haar_encode(strided_view<Real, 3> latent, in_view<Real, 3> image) {
    auto const [colours, height, width] = image.extents();
    require_value(height % 2 == 0, "haar_encode", "height of image", height, "an even number");
    require_value(width % 2 == 0, "haar_encode", "width of image", width, "an even number");
    require_shape("haar_encode", "latent", latent, {4 * colours, height / 2, width / 2});
    for (std::size_t colour = 0; colour < colours; ++colour) {
        for (std::size_t row = 0; row < height / 2; ++row) {
            for (std::size_t column = 0; column < width / 2; ++column) {
                auto const x = [&, c = colour](std::size_t down, std::size_t right) {
                    return 2 * image(c, 2 * row + down, 2 * column + right) - 1;
                };
                auto const bands = internal::haar_square(x(0, 0), x(0, 1), x(1, 0), x(1, 1));
                for (std::size_t band = 0; band < 4; ++band) {
                    auto const [scale, shift] = internal::haar_scalings[band];
                    latent(band * colours + colour, row, column) =
                        static_cast<Real>(scale) * (bands[band] + static_cast<Real>(shift));
                }
            }
        }
    }
}

/// Writes the image [colours, height, width] of latents [4 colours, height / 2, width / 2]: the inverse of haar_encode.
/// Values are not clamped to [0, 1]. Throws value_error if the channels are no multiple of 4, shape_error if the image
/// does not fit.
template <class Real>
void haar_decode(strided_view<Real, 3> image, in_view<Real, 3> latent) {
    require_value(latent.extent(0) % 4 == 0, "haar_decode", "channels of latent", latent.extent(0), "a multiple of 4");
    auto const colours = latent.extent(0) / 4;
    require_shape("haar_decode", "image", image, {colours, 2 * latent.extent(1), 2 * latent.extent(2)});
    for (std::size_t colour = 0; colour < colours; ++colour) {
        for (std::size_t row = 0; row < latent.extent(1); ++row) {
            for (std::size_t column = 0; column < latent.extent(2); ++column) {
                std::array<Real, 4> bands{};
                for (std::size_t band = 0; band < 4; ++band) {
                    auto const [scale, shift] = internal::haar_scalings[band];
                    bands[band] = latent(band * colours + colour, row, column) / static_cast<Real>(scale) -
                                  static_cast<Real>(shift);
                }
                auto const square = internal::haar_square(bands[0], bands[1], bands[2], bands[3]);
                for (std::size_t i = 0; i < 4; ++i) {
                    image(colour, 2 * row + i / 2, 2 * column + i % 2) = (square[i] + 1) / 2;
                }
            }
        }
    }
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
