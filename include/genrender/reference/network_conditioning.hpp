// SPDX-License-Identifier: MIT
// What the reference network is told beside the latents: hints of all frames, the prompt, how strongly to follow them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/stack.hpp>

#include <cstddef>

namespace genrender::reference {

/// The conditioning of a run. Prompts are tokens, of clip_text_encoder or of any other text encoder.
template <class Real>
struct network_conditioning {
    stack<Real, 4> hint;         ///< of every frame of the animation [frames, conditioning_channels, height, width]
    stack<Real, 2> prompt;       ///< [tokens, cross_attention_dim]
    stack<Real, 2> empty_prompt; ///< or the negative one [tokens, cross_attention_dim]; unused with guidance_scale 1
    Real guidance_scale = 7.5;   ///< of classifier-free guidance; 1 runs the prompt alone
    Real conditioning_scale = 1; ///< factor of what the ControlNet adds; 0 is as if it were not there
    Real guidance_rescale = 0;   ///< share of rescale_guidance, in [0, 1]
};

/// The hint of a depth-conditioned ControlNet [frames, channels, height, width] of the pictures: inverse depth
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

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
