// SPDX-License-Identifier: MIT
// The autoencoder between pictures and latents (Rombach et al. 2022), layer for layer diffusers' AutoencoderKL.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/autoencoder_config.hpp>
#include <genrender/reference/map_stripes.hpp>
#include <genrender/reference/spare_map.hpp>
#include <genrender/reference/vae_decoder.hpp>
#include <genrender/reference/vae_encoder.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

// Diffusers decodes large pictures in tiles that overlap, each with GroupNorm's moments and attention of its own, and
// blends them; random weights of Stable Diffusion's size then differ from the whole by up to 3 % of the picture's range
// (tests/reference/full_size_ends.py measures it). Here nothing is cut: every layer passes over the whole map in stripes
// of rows, under the moments of the whole map, and writes over what it has read. So there are no seams, and memory is
// that of two and a half maps of the finest level: 2.5 * 4 bytes * 128 channels a pixel.

namespace genrender::reference {

/// Which halves of an autoencoder are loaded.
enum class autoencoder_parts {
    both,    ///< encoder and decoder
    decoder, ///< the decoder alone; tensors of the encoder are left in the file
};

/// The normal distribution of a picture's latent, in the diffusion's scale.
template <class Real>
struct latent_distribution {
    stack<Real, 3> mean;         ///< [latent_channels, height, width], which is its mode too
    stack<Real, 3> log_variance; ///< [latent_channels, height, width]
};

/// Encoder and decoder. Latents are those of the diffusion, (z - shift_factor) scaling_factor of what the networks see.
template <class Real>
class autoencoder_kl {
public:
    /// Takes every tensor of diffusers' AutoencoderKL from `source`, or those of the decoder. Throws value_error if the
    /// config cannot be built, file_error if a tensor is missing, misshapen or left over.
    autoencoder_kl(autoencoder_config const& config, weights<Real>& source,
                   autoencoder_parts parts = autoencoder_parts::both)
        : config_((require_config(config), config)), decoder_(config_, source) {
        if (parts == autoencoder_parts::both) {
            encoder_.emplace(config_, source);
        } else {
            source.leave("encoder.");
            source.leave("quant_conv.");
        }
        source.require_all_taken();
    }

    /// The architecture that it is of.
    autoencoder_config const& config() const { return config_; }

    /// The picture [3, scale height, scale width] of a latent [latent_channels, height, width]; about in [-1, 1], and
    /// not clamped. `pass` says on which threads it runs and how much memory a stripe takes; the result does not depend
    /// on it, to the last bit. Throws shape_error if z has other channels, value_error if it is empty.
    stack<Real, 3> decode(in_view<Real, 3> z, stripe_pass const& pass = {}) const {
        grid_extents const grid{z.extent(1), z.extent(2)};
        require_shape("autoencoder_kl", "z", z, {config_.latent_channels, grid.height, grid.width});
        require_value(grid.size() > 0, "autoencoder_kl", "z", "empty", "at least one token");
        auto const factor = static_cast<Real>(config_.scaling_factor);
        auto const shift = static_cast<Real>(config_.shift_factor);
        auto result = stack<Real, 3>::uninitialized({3, config_.scale() * grid.height, config_.scale() * grid.width});
        decoder_(result.view(), tokens_of(z, [&](Real value) { return value / factor + shift; }), pass);
        return result;
    }

    /// The distribution of the latent of a picture [3, height, width] in [-1, 1], both extents multiples of
    /// config().scale(). Log variances are clamped to [-30, 20] before they are scaled, as diffusers does. `pass` is
    /// as for decode. Throws shape_error if there are other than 3 channels, value_error for other extents or if the
    /// encoder was not loaded.
    latent_distribution<Real> encode(in_view<Real, 3> picture, stripe_pass const& pass = {}) const {
        require_value(encoder_.has_value(), "autoencoder_kl", "encoder", "not loaded", "autoencoder_parts::both");
        grid_extents const grid{picture.extent(1), picture.extent(2)};
        require_shape("autoencoder_kl", "picture", picture, {3, grid.height, grid.width});
        require_picture_grid(config_, grid);
        auto const moments = (*encoder_)(tokens_of(picture, [](Real value) { return value; }), pass);
        std::array const extents{config_.latent_channels, moments.grid().height, moments.grid().width};
        auto const factor = static_cast<Real>(config_.scaling_factor);
        auto const shift = static_cast<Real>(config_.shift_factor);
        auto const widening = static_cast<Real>(2 * std::log(config_.scaling_factor));
        latent_distribution<Real> result{stack<Real, 3>::uninitialized(extents),
                                         stack<Real, 3>::uninitialized(extents)};
        for (std::size_t token = 0; token < moments.grid().size(); ++token) {
            auto const y = token / extents[2];
            auto const x = token % extents[2];
            for (std::size_t c = 0; c < extents[0]; ++c) {
                auto const log_variance = moments.view()(token, extents[0] + c);
                result.mean(c, y, x) = (moments.view()(token, c) - shift) * factor;
                result.log_variance(c, y, x) = std::clamp(log_variance, Real{-30}, Real{20}) + widening;
            }
        }
        return result;
    }

private:
    /// Channels side by side, after `f`.
    template <class Function>
    static spare_map<Real> tokens_of(strided_view<Real const, 3> const& maps, Function const& f) {
        spare_map<Real> result({maps.extent(1), maps.extent(2)}, maps.extent(0));
        auto const to = result.view();
        for (std::size_t c = 0; c < maps.extent(0); ++c) {
            for (std::size_t token = 0; token < to.extent(0); ++token) {
                to(token, c) = f(maps(c, token / maps.extent(2), token % maps.extent(2)));
            }
        }
        return result;
    }

    autoencoder_config config_;
    vae_decoder<Real> decoder_;
    std::optional<vae_encoder<Real>> encoder_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
