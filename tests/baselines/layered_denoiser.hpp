// SPDX-License-Identifier: MIT
// A small random network in which what attention does at one site shapes the features of the next: three decoder sites
// on two grids, after one of the encoder.
#pragma once

#include "../injection/dense_equations.hpp"

#include <genrender/injection/host_attention_call.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

namespace genrender::testing {

/// D(z, sigma) with two guidance branches, latents of 3 x 8 x 8, features of 6 channels and residuals around attention.
template <class Real>
struct layered_denoiser {
    using real_type = Real;
    using features_type = host_features<Real>;
    /// F of the module at a place for features f of all frames of a stack.
    using attention = std::function<features_type(attention_place, features_type const&)>;

    static constexpr grid_extents grid{8, 8};
    static constexpr grid_extents coarse{4, 4};
    static constexpr std::size_t channels = 6;
    Real conditioning = 1; ///< how much the network knows of the frame's number
    std::array<attention_site, 4> modules{
        {{"down.attn1", network_kind::denoising, network_part::encoder, grid, channels},
         {"up.0.attn1", network_kind::denoising, network_part::decoder, coarse, channels},
         {"up.1.attn1", network_kind::denoising, network_part::decoder, grid, channels},
         {"up.2.attn1", network_kind::denoising, network_part::decoder, grid, channels}}};
    std::deque<matrix_module<Real>> weights;
    std::array<stack<Real, 2>, 2> lift; // of each branch, [channels, 3]

    layered_denoiser() {
        for (std::uint64_t site = 0; site < modules.size(); ++site) {
            weights.emplace_back(channels, 2, 100 + 10 * site);
        }
        for (std::size_t branch = 0; branch < lift.size(); ++branch) {
            lift[branch] = random_stack<Real, 2>({channels, 3}, 7 + branch);
        }
    }

    std::size_t latent_channels() const { return 3; }
    grid_extents latent_grid() const { return grid; }
    std::span<attention_site const> sites() const { return modules; }
    std::size_t branches() const { return lift.size(); }

    template <class Processor>
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        denoise(x0, z, sigma, frames, [&](attention_place place, features_type const& f) {
            host_attention_call<Real, matrix_module<Real>> call(place, frames, f, weights[place.site.value]);
            return processor(call);
        });
    }

    /// The network, told what its attention modules do.
    void denoise(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                 std::span<frame_index const> frames, attention const& attend) const {
        auto const scale = 1 / std::sqrt(1 + sigma * sigma);
        for (std::uint32_t branch = 0; branch < branches(); ++branch) {
            auto const& L = lift[branch];
            auto const features = features_type::allocate({frames.size(), grid.size(), channels});
            auto const f = features.view();
            each(f, [&](std::size_t i, std::size_t t, std::size_t c) {
                auto const knows = std::sin(static_cast<Real>(frames[i].value * (c + 1)));
                auto& out = f(i, t, c);
                out = conditioning * knows;
                for (std::size_t k = 0; k < 3; ++k) {
                    out += L(c, k) * scale * z(i, k, t / grid.width, t % grid.width);
                }
            });
            for (std::uint32_t site = 0; site < modules.size(); ++site) {
                auto const& site_grid = modules[site].grid;
                auto const cell = grid.width / site_grid.width;
                auto const token_of = [&](std::size_t t) {
                    return t / grid.width / cell * site_grid.width + t % grid.width / cell;
                };
                auto const pooled = features_type::allocate({frames.size(), site_grid.size(), channels});
                auto const sums = pooled.view();
                each(f, [&](std::size_t i, std::size_t t, std::size_t c) {
                    sums(i, token_of(t), c) += f(i, t, c) / static_cast<Real>(cell * cell);
                });
                auto const attended = attend({{site}, branch}, pooled);
                auto const F = attended.view();
                each(f, [&](std::size_t i, std::size_t t, std::size_t c) {
                    auto& own = f(i, t, c);
                    own = std::tanh(own + F(i, token_of(t), c));
                });
            }
            for (std::size_t i = 0; i < frames.size(); ++i) {
                for (std::size_t t = 0; t < grid.size(); ++t) {
                    for (std::size_t k = 0; k < 3; ++k) {
                        auto& out = x0(i, k, t / grid.width, t % grid.width);
                        auto const own = f(i, t, k) + f(i, t, k + 3);
                        out = branch == 0 ? own : 2 * own - out; // a guidance scale of 2
                    }
                }
            }
        }
    }

private:
    template <class Visit>
    static void each(strided_view<Real, 3> const& f, Visit const& visit) {
        for (std::size_t i = 0; i < f.extent(0); ++i) {
            for (std::size_t t = 0; t < f.extent(1); ++t) {
                for (std::size_t c = 0; c < channels; ++c) {
                    visit(i, t, c);
                }
            }
        }
    }
};

/// Writes rows into frame i of F.
template <class Real>
void put_rows(host_features<Real> const& F, std::size_t i, token_rows const& rows) {
    auto const view = F.view();
    for (std::size_t t = 0; t < rows.size(); ++t) {
        for (std::size_t c = 0; c < rows[t].size(); ++c) {
            view(i, t, c) = static_cast<Real>(rows[t][c]);
        }
    }
}

/// One evaluation with all frames in lockstep, where `rule(place, f, i)` gives the rows of frame i at the decoder's
/// sites and the encoder's frames are left to themselves: what a method must equal.
template <class Real, class Rule>
stack<Real, 4> plain_evaluation(layered_denoiser<Real> const& phi, strided_view<Real const, 4> z, Real sigma,
                                Rule const& rule) {
    std::vector<frame_index> frames;
    for (std::uint32_t i = 0; i < z.extent(0); ++i) {
        frames.push_back({i});
    }
    stack<Real, 4> x0(z.extents());
    phi.denoise(x0.view(), z, sigma, frames, [&](attention_place place, host_features<Real> const& f) {
        auto const F = host_features<Real>::allocate(f.extents());
        for (std::size_t i = 0; i < frames.size(); ++i) {
            auto const own = joined_rows(f, {i});
            put_rows(F, i, place.site.value == 0 ? dense_self_attention(phi.weights[0], own, own) : rule(place, f, i));
        }
        return F;
    });
    return x0;
}

} // namespace genrender::testing
