// SPDX-License-Identifier: MIT
// A denoiser whose network costs nothing, so that what a run takes is what the library takes.
#pragma once

#include <genrender/attention/attention_call.hpp>
#include <genrender/sampling/classifier_free_guidance.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace genrender::benchmarks {

/// The sites, latents and guidance of Stable Diffusion 1.5 without its network, as if its features lay on a device that
/// is done at once: handles stand for nothing, products return at once, and what the network finds is what it is given.
/// What is left for the denoiser to do is real: both branches, guidance, the clean estimate.
class costless_denoiser {
public:
    using real_type = float;
    struct features_type {};

    /// With latents of `side` x `side`, 64 for images of 512 x 512; a multiple of 8.
    explicit costless_denoiser(std::size_t side = 64) : side_(side) {
        using enum network_part;
        add(encoder, {side, side / 2, side / 4}, 2);
        add(middle, {side / 8}, 1);
        add(decoder, {side / 4, side / 2, side}, 3);
    }

    std::size_t latent_channels() const { return 4; }
    grid_extents latent_grid() const { return {side_, side_}; }
    /// Their channels are 0: nothing of them is in the memory of the host.
    std::span<attention_site const> sites() const { return sites_; }
    std::size_t branches() const { return 2; }

    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        for (std::uint32_t branch = 0; branch < branches(); ++branch) {
            for (std::uint32_t site = 0; site < sites_.size(); ++site) {
                call at{{{site}, branch}, frames};
                processor(at);
            }
        }
        guide(x0, z, z, 7.5F);
        to_clean(x0, prediction::clean, z, x0, sigma);
    }

private:
    /// A run of a site that ends before it begins.
    struct call {
        using real_type = float;
        using features_type = costless_denoiser::features_type;
        using sources_type = attention_sources<features_type>;

        attention_place at;
        std::span<frame_index const> of;

        attention_place place() const { return at; }
        std::span<frame_index const> frames() const { return of; }
        features_type f() const { return {}; }
        features_type query(features_type) const { return {}; }
        features_type key(features_type) const { return {}; }
        features_type value(features_type) const { return {}; }
        features_type attend(features_type, sources_type const&) const { return {}; }
        features_type mix(features_type, features_type, std::span<sparse_rows<float> const>, float) const { return {}; }
    };

    void add(network_part part, std::vector<std::size_t> const& sides, std::size_t count) {
        for (auto const side : sides) {
            for (std::size_t i = 0; i < count; ++i) {
                auto const name = std::to_string(side) + "." + std::to_string(i);
                sites_.push_back({name, network_kind::denoising, part, {side, side}, 0});
            }
        }
    }

    std::size_t side_;
    std::vector<attention_site> sites_;
};

} // namespace genrender::benchmarks
