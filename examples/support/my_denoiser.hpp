// SPDX-License-Identifier: MIT
// What a denoiser made of my_engine is, whichever way its attention is wired: sites, branches, the way of latents
// through it.
#pragma once

#include "my_engine.hpp"

#include <genrender/attention/attention_site.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// The door: how the library looks into the engine's tensors. It lies in the engine's namespace and copies nothing.
// docs:begin to_view
namespace my_engine {
inline genrender::strided_view<float, 3> to_view(tensor const& t) { return {t.memory.get(), t.sizes, t.strides}; }
} // namespace my_engine
// docs:end

namespace genrender::examples {

/// What both ways share: what the network is, and the way of latents through it. Prompts and guidance are its own.
// docs:begin my_denoiser
struct my_denoiser {
    using real_type = float;
    using features_type = my_engine::tensor;
    static constexpr grid_extents grid{8, 8};
    my_engine::network net;
    std::array<attention_site, 2> modules{
        {{"down.attn1", network_kind::denoising, network_part::encoder, grid, net.channels},
         {"up.attn1", network_kind::denoising, network_part::decoder, grid, net.channels}}};
    std::size_t latent_channels() const { return net.latent_channels; }
    grid_extents latent_grid() const { return grid; }
    std::span<attention_site const> sites() const { return modules; }
    std::size_t branches() const { return net.prompts; }

    /// D(z, sigma) of a network that predicts v; run(place, f) runs a self-attention module.
    template <class Run>
    void denoise(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma, Run const& run) const {
        my_engine::tensor latents(z.extent(0), grid.size(), z.extent(1));
        copy(channels_first(latents), z);
        auto const v = net(latents, sigma, [&](std::uint32_t prompt, std::uint32_t module, my_engine::tensor const& f) {
            return run(attention_place{{module}, prompt}, f);
        });
        to_clean(x0, prediction::velocity, z, channels_first(v), sigma);
    }
    static strided_view<float, 4> channels_first(my_engine::tensor const& t) {
        auto const [frame, token, channel] = t.strides;
        return {t.memory.get(),
                {t.sizes[0], t.sizes[2], grid.height, grid.width},
                {frame, channel, token * std::ptrdiff_t{grid.width}, token}};
    }
};
// docs:end

} // namespace genrender::examples
