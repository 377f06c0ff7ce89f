// SPDX-License-Identifier: MIT
// [GR alg. 1] One evaluation of the algorithm's body written down plainly, with dense textures and dense attention, for
// the analytic denoiser: what the sequence denoiser must equal.
#pragma once

#include <genrender/testing/analytic_denoiser.hpp>
#include "dense_texture.hpp"

#include <genrender/core/stack.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace genrender::testing {

/// Softmax(Q K^T / sqrt(d)) V with K = V = the rows of all `sources`, one after the other.
template <class Real>
std::vector<std::vector<Real>> dense_attention(std::vector<std::vector<Real>> const& Q,
                                               std::vector<std::vector<Real>> const& sources) {
    std::vector<std::vector<Real>> F;
    for (auto const& q : Q) {
        std::vector<Real> exponentials;
        Real sum = 0;
        for (auto const& k : sources) {
            Real logit = 0;
            auto const* k_c = k.data();
            for (auto const q_c : q) {
                logit += q_c * *k_c++;
            }
            exponentials.push_back(std::exp(logit / std::sqrt(static_cast<Real>(q.size()))));
            sum += exponentials.back();
        }
        std::vector<Real> out(q.size());
        for (std::size_t k = 0; k < sources.size(); ++k) {
            auto const weight = exponentials[k] / sum;
            auto const* value = sources[k].data();
            for (auto& out_c : out) {
                out_c += weight * *value++;
            }
        }
        F.push_back(out);
    }
    return F;
}

/// x0 [frames, channels, height, width] of one evaluation at z and sigma with the keyframes KF: alpha and the texture's
/// T are constant, the mean of first fill and average is taken, latents are not normalised.
template <class Real>
stack<Real, 4> plain_algorithm(analytic_denoiser<Real> const& phi, uv_maps const& maps, std::size_t objects,
                               std::size_t T, strided_view<Real const, 4> z, Real sigma,
                               std::vector<frame_index> const& KF, Real alpha) {
    using tokens_type = std::vector<std::vector<Real>>;
    auto const grid = phi.grid;
    auto const gain = phi.spread * phi.spread / (phi.spread * phi.spread + sigma * sigma);
    auto const posterior = [&](std::size_t i) {
        tokens_type f(grid.size(), std::vector<Real>(phi.channels));
        for (std::size_t t = 0; t < grid.size(); ++t) {
            for (std::size_t c = 0; c < phi.channels; ++c) {
                f[t][c] = phi.mean + gain * (z(i, c, t / grid.width, t % grid.width) - phi.mean);
            }
        }
        return f;
    };
    stack<Real, 4> x0({z.extent(0), z.extent(1), z.extent(2), z.extent(3)});
    for (std::size_t branch = 0; branch < phi.guidance_branches; ++branch) {
        auto const sign = branch == 0 ? Real{1} : Real{-1};
        auto const features = [&](std::size_t i) {
            auto f = posterior(i);
            for (auto& token : f) {
                for (auto& value : token) {
                    value *= sign;
                }
            }
            return f;
        };
        // f_KF, F_KF <- Phi(z_KF): every keyframe attends to all keyframes.
        tokens_type f_KF;
        for (auto const k : KF) {
            auto const f = features(k.value);
            f_KF.insert(f_KF.end(), f.begin(), f.end());
        }
        std::vector<dense_texture<Real>> unprojected;
        for (auto const k : KF) {
            auto const F = dense_attention(features(k.value), f_KF);
            stack<Real, 2> rows({grid.size(), phi.channels});
            for (std::size_t t = 0; t < grid.size(); ++t) {
                for (std::size_t c = 0; c < phi.channels; ++c) {
                    rows(t, c) = F[t][c];
                }
            }
            unprojected.push_back(dense_unproject<Real>(maps, k.value, rows.view(), grid, objects, T));
        }
        auto const texture = dense_blend(unprojected);
        // z^i <- Phi(z^i, f_KF, F_bar^i)
        for (std::size_t i = 0; i < z.extent(0); ++i) {
            auto const f = features(i);
            auto joined = f;
            joined.insert(joined.end(), f_KF.begin(), f_KF.end());
            auto F = dense_attention(f, joined);
            for (std::size_t t = 0; t < grid.size(); ++t) {
                auto const texel = dense_texel_of(maps, i, grid, t, objects, T);
                for (std::size_t c = 0; c < phi.channels; ++c) {
                    if (texel && texture.filled[*texel] != 0) {
                        F[t][c] = alpha * texture.values[*texel * phi.channels + c] + (1 - alpha) * F[t][c];
                    }
                    auto const share = (1 - phi.attention) * sign * f[t][c] + phi.attention * sign * F[t][c];
                    x0(i, c, t / grid.width, t % grid.width) += share / static_cast<Real>(phi.guidance_branches);
                }
            }
        }
    }
    return x0;
}

} // namespace genrender::testing
