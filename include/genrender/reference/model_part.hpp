// SPDX-License-Identifier: MIT
// The networks that a pipeline is made of, whose files lie apart.
#pragma once

#include <genrender/core/begin_header.inl>

namespace genrender::reference {

/// A network of a pipeline.
enum class model_part {
    unet,        ///< the denoising network
    controlnet,  ///< the network that looks at depth
    vae,         ///< between pictures and latents
    text_encoder ///< between words and the tokens that the UNet attends to
};

/// `UNet`, `ControlNet`, `VAE` or `text encoder`.
inline char const* name_of(model_part part) {
    switch (part) {
    case model_part::controlnet:
        return "ControlNet";
    case model_part::vae:
        return "VAE";
    case model_part::text_encoder:
        return "text encoder";
    default:
        return "UNet";
    }
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
