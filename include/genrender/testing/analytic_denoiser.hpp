// SPDX-License-Identifier: MIT
// A denoiser whose exact answer is known: clean latents are N(mean, spread^2) in every pixel, and attention is a share
// of it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/injection/host_attention_call.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace genrender::testing {

/// Projections that leave features as they are: Q = K = V = f.
struct identity_projections {
    /// Q = f.
    template <class Real>
    void query(strided_view<Real, 2> out, strided_view<Real const, 2> f) const {
        copy(out, in_view<Real, 2>(f));
    }
    /// K = f.
    template <class Real>
    void key(strided_view<Real, 2> out, strided_view<Real const, 2> f) const {
        copy(out, in_view<Real, 2>(f));
    }
    /// V = f.
    template <class Real>
    void value(strided_view<Real, 2> out, strided_view<Real const, 2> f) const {
        copy(out, in_view<Real, 2>(f));
    }
    /// One attention head.
    std::size_t heads() const { return 1; }
};

/// D(z, sigma) = (1 - attention) E[clean given z] + attention F, where E is the posterior mean for clean ~ N(mean,
/// spread^2) and F the output of one decoder site whose input is the posterior mean, a token a pixel. With attention =
/// 0 the sampler's limit is known: z_0 = mean + (z_T - mean) spread / sqrt(spread^2 + sigma_T^2).
template <class Real>
struct analytic_denoiser {
    using real_type = Real;                    ///< scalar of the latents
    using features_type = host_features<Real>; ///< features in host memory

    grid_extents grid;                 ///< height and width of the latents, and of every feature map
    std::size_t channels = 3;          ///< of the latents and of the features
    Real mean = Real(0.5);             ///< of the data that it is the denoiser of
    Real spread = Real(0.25);          ///< standard deviation of these data
    Real attention = 0;                ///< share of F in the estimate, in [0, 1]
    std::size_t guidance_branches = 1; ///< how often each site runs
    /// Its self-attention modules; the output of the last is F.
    std::vector<attention_site> site_list = {
        {"encoder.attn1", network_kind::denoising, network_part::encoder, grid, channels},
        {"control.attn1", network_kind::control, network_part::decoder, grid, channels},
        {"decoder.attn1", network_kind::denoising, network_part::decoder, grid, channels}};

    /// Channels of z.
    std::size_t latent_channels() const { return channels; }
    /// Height and width of z.
    grid_extents latent_grid() const { return grid; }
    /// Its self-attention modules.
    std::span<attention_site const> sites() const { return site_list; }
    /// Guidance branches that it runs.
    std::size_t branches() const { return guidance_branches; }

    /// Writes D(z, sigma) into x0, running the processor at each site.
    template <class Processor>
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto const posterior = posterior_of(z, sigma);
        // Branches differ in their features by sign, so that mixing them up would show.
        identity_projections const module;
        std::vector<features_type> F;
        for (std::uint32_t branch = 0; branch < guidance_branches; ++branch) {
            auto const f = scaled(posterior, sign_of(branch));
            for (std::uint32_t site = 0; site < site_list.size(); ++site) {
                host_attention_call<Real, identity_projections> call({{site}, branch}, frames, f, module);
                auto const out = processor(call);
                if (site + 1 == site_list.size()) {
                    F.push_back(out);
                }
            }
        }
        mix(x0, posterior, F);
    }

private:
    static Real sign_of(std::size_t branch) { return branch == 0 ? Real{1} : Real{-1}; }

    /// [frames, tokens, channels] of z.
    features_type posterior_of(strided_view<Real const, 4> z, Real sigma) const {
        auto const posterior = features_type::allocate({z.extent(0), grid.size(), channels});
        auto const view = posterior.view();
        auto const gain = spread * spread / (spread * spread + sigma * sigma);
        for_each(z, [&](std::size_t i, std::size_t c, std::size_t row, std::size_t column) {
            view(i, row * grid.width + column, c) = mean + gain * (z(i, c, row, column) - mean);
        });
        return posterior;
    }

    static features_type scaled(features_type const& posterior, Real sign) {
        auto const f = features_type::allocate(posterior.extents());
        auto const* from = posterior.view().data();
        auto* const to = f.view().data();
        auto const count = f.view().size();
        for (std::size_t e = 0; e < count; ++e) {
            to[e] = sign * from[e];
        }
        return f;
    }

    /// x0 of the posterior and of what the branches' last sites gave.
    void mix(strided_view<Real, 4> x0, features_type const& posterior, std::vector<features_type> const& F) const {
        auto const own = posterior.view();
        std::vector<strided_view<Real, 3>> of_branches;
        for (auto const& out : F) {
            of_branches.push_back(out.view());
        }
        for_each(x0, [&](std::size_t i, std::size_t c, std::size_t row, std::size_t column) {
            auto const t = row * grid.width + column;
            Real mixed = 0;
            for (std::size_t branch = 0; branch < guidance_branches; ++branch) {
                mixed += sign_of(branch) * of_branches[branch](i, t, c) / static_cast<Real>(guidance_branches);
            }
            x0(i, c, row, column) = (1 - attention) * own(i, t, c) + attention * mixed;
        });
    }

    template <class View, class Visit>
    static void for_each(View const& view, Visit const& visit) {
        for (std::size_t i = 0; i < view.extent(0); ++i) {
            for (std::size_t c = 0; c < view.extent(1); ++c) {
                for (std::size_t row = 0; row < view.extent(2); ++row) {
                    for (std::size_t column = 0; column < view.extent(3); ++column) {
                        visit(i, c, row, column);
                    }
                }
            }
        }
    }
};

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
