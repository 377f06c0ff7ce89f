// SPDX-License-Identifier: MIT
// What the reference network is told beside the latents: hints of all frames, the prompt, how strongly to follow them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/reference/haar.hpp>
#include <genrender/reference/unet_config.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace genrender::reference {

/// The conditioning of a run. Prompts are tokens, so that those of a real text encoder fit as well.
template <class Real>
struct network_conditioning {
    stack<Real, 4> hint;         ///< of every frame of the animation [frames, conditioning_channels, height, width]
    stack<Real, 2> prompt;       ///< [tokens, cross_attention_dim]
    stack<Real, 2> empty_prompt; ///< or the negative one [tokens, cross_attention_dim]; unused with guidance_scale 1
    Real guidance_scale = 2;     ///< of classifier-free guidance; 1 runs the prompt alone
    Real conditioning_scale = 1; ///< factor of what the ControlNet adds; 0 is as if it were not there
    Real guidance_rescale = 0;   ///< share of rescale_guidance, in [0, 1]
};

/// The hint of a depth-conditioned ControlNet at image resolution [frames, channels, height, width]: inverse depth
/// [frames, height, width] in [0, 1], nearest = 1, repeated over the channels. Throws value_error at an inverse depth
/// that is not finite.
template <class Real>
stack<Real, 4> depth_hint(strided_view<float const, 3> inverse_depth, std::size_t channels = 3) {
    auto const [frames, height, width] = inverse_depth.extents();
    stack<Real, 4> hint({frames, channels, height, width});
    for (std::size_t frame = 0; frame < frames; ++frame) {
        for (std::size_t row = 0; row < height; ++row) {
            for (std::size_t column = 0; column < width; ++column) {
                auto const value = inverse_depth(frame, row, column);
                require_value(is_finite(value), "depth_hint", "inverse_depth", value, "finite numbers");
                for (std::size_t channel = 0; channel < channels; ++channel) {
                    hint(frame, channel, row, column) = static_cast<Real>(value);
                }
            }
        }
    }
    return hint;
}

/// The hint of a ControlNet at latent resolution [frames, 4, height / 2, width / 2], the Haar bands (see haar.hpp) of
/// inverse depth y [frames, height, width] in [0, 1]: the mean of 2 y - 1 over each square in [-1, 1], then the three
/// details of y, which are slopes of the surface, times 12 and clamped to [-4, 4]. Throws value_error for odd extents
/// and at an inverse depth that is not finite.
template <class Real>
stack<Real, 4> haar_hint(strided_view<float const, 3> inverse_depth) {
    auto const [frames, height, width] = inverse_depth.extents();
    require_value(height % 2 == 0, "haar_hint", "height of inverse_depth", height, "an even number");
    require_value(width % 2 == 0, "haar_hint", "width of inverse_depth", width, "an even number");
    stack<Real, 4> hint({frames, 4, height / 2, width / 2});
    for (std::size_t frame = 0; frame < frames; ++frame) {
        for (std::size_t row = 0; row < height / 2; ++row) {
            for (std::size_t column = 0; column < width / 2; ++column) {
                std::array<Real, 4> y{};
                for (std::size_t i = 0; i < 4; ++i) {
                    auto const value = inverse_depth(frame, 2 * row + i / 2, 2 * column + i % 2);
                    require_value(is_finite(value), "haar_hint", "inverse_depth", value, "finite numbers");
                    y[i] = static_cast<Real>(value);
                }
                auto const bands = internal::haar_square(y[0], y[1], y[2], y[3]);
                hint(frame, 0, row, column) = bands[0] - 1;
                for (std::size_t band = 1; band < 4; ++band) {
                    hint(frame, band, row, column) = std::clamp(12 * bands[band], Real(-4), Real(4));
                }
            }
        }
    }
    return hint;
}

/// The hint that a network takes for inverse depth [frames, height, width] in [0, 1]: haar_hint if it is as large as
/// the latents, which then have half the height and width of the depth, else depth_hint. Throws as they do.
template <class Real>
stack<Real, 4> hint_of(unet_config const& config, strided_view<float const, 3> inverse_depth) {
    return config.hint_scale() == 1 ? haar_hint<Real>(inverse_depth)
                                    : depth_hint<Real>(inverse_depth, config.conditioning_channels);
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
