// SPDX-License-Identifier: MIT
// A denoiser with few pixels and many channels, as large networks have them, that counts what it is asked for.
#pragma once

#include <genrender/testing/analytic_denoiser.hpp>

#include <genrender/injection/host_attention_call.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace genrender::testing {

/// D(z, sigma) = half the posterior mean of N(0, 1) and half what attention makes of it, at three sites of 64 channels
/// on the latents' grid of 8 x 8; the last two are of the decoder.
struct wide_denoiser {
    using real_type = float;
    using features_type = host_features<float>;

    static constexpr grid_extents grid{8, 8};
    static constexpr std::size_t channels = 64;
    std::array<attention_site, 3> modules{{{"in", network_kind::denoising, network_part::encoder, grid, channels},
                                           {"out.0", network_kind::denoising, network_part::decoder, grid, channels},
                                           {"out.1", network_kind::denoising, network_part::decoder, grid, channels}}};
    mutable std::atomic<std::size_t> attention_flops{0}; ///< of all calls so far, 4 N N_kv C

    std::size_t latent_channels() const { return 4; }
    grid_extents latent_grid() const { return grid; }
    std::span<attention_site const> sites() const { return modules; }
    std::size_t branches() const { return 1; }

    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto const gain = 1 / (1 + sigma * sigma);
        auto f = features_type::allocate({frames.size(), grid.size(), channels});
        for (std::size_t i = 0; i < frames.size(); ++i) {
            for (std::size_t t = 0; t < grid.size(); ++t) {
                for (std::size_t c = 0; c < channels; ++c) {
                    f.view()(i, t, c) = gain * z(i, c % 4, t / grid.width, t % grid.width);
                }
            }
        }
        for (std::uint32_t site = 0; site < modules.size(); ++site) {
            counting_call call({{site}, 0}, frames, f, *this);
            f = processor(call);
        }
        for (std::size_t i = 0; i < frames.size(); ++i) {
            for (std::size_t t = 0; t < grid.size(); ++t) {
                for (std::size_t c = 0; c < 4; ++c) {
                    auto const own = gain * z(i, c, t / grid.width, t % grid.width);
                    x0(i, c, t / grid.width, t % grid.width) = (own + f.view()(i, t, c)) / 2;
                }
            }
        }
    }

private:
    static constexpr identity_projections projections{};

    /// The call of host memory that counts the products of attention.
    class counting_call : public host_attention_call<float, identity_projections> {
    public:
        counting_call(attention_place place, std::span<frame_index const> frames, features_type f,
                      wide_denoiser const& phi)
            : host_attention_call<float, identity_projections>(place, frames, std::move(f), projections), phi_(&phi) {}

        features_type attend(features_type const& Q, attention_sources<features_type> const& sources) const {
            for (auto const& blocks : sources) {
                for (auto const& block : blocks) {
                    phi_->attention_flops += 4 * Q.extents()[1] * block.K->extents()[1] * Q.extents()[2];
                }
            }
            return host_attention_call<float, identity_projections>::attend(Q, sources);
        }

    private:
        wide_denoiser const* phi_;
    };
};

} // namespace genrender::testing
