// SPDX-License-Identifier: MIT
// [GR sec. 3.1] Where in a network self-attention happens, and for which guidance branch.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>

namespace genrender {

/// Which of the networks that a denoiser runs holds a self-attention module.
enum class network_kind : std::uint8_t {
    denoising, ///< the network that predicts the latents
    control    ///< a ControlNet or the like beside it, whose attention is usually left alone
};

/// Which part of the network holds it.
enum class network_part : std::uint8_t {
    encoder, ///< on the way to the coarsest grid
    middle,  ///< at the coarsest grid
    decoder  ///< on the way back
};

/// One self-attention module of a denoiser, described once for all calls.
struct attention_site {
    std::string name; ///< as the engine calls it, say `up_blocks.1.attentions.0.transformer_blocks.0.attn1`
    network_kind network = network_kind::denoising; ///< the network that the module is a part of
    network_part part = network_part::decoder;      ///< the part of that network
    grid_extents grid;                              ///< of its feature map; tokens are row * width + column
    std::size_t channels = 0;                       ///< of its features, a token's length
};

/// Position of a site in its denoiser's list of sites.
struct site_index {
    std::uint32_t value = 0; ///< from 0, in the order of sites()
    /// Orders by position.
    friend constexpr auto operator<=>(site_index, site_index) = default;
};

/// One run of a site: features of different guidance branches (the unconditional and the conditional one of
/// classifier-free guidance) never meet.
struct attention_place {
    site_index site;          ///< the module
    std::uint32_t branch = 0; ///< guidance branch, from 0; how many there are says branches()
    /// Orders by site, then by branch.
    friend constexpr auto operator<=>(attention_place, attention_place) = default;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
