// SPDX-License-Identifier: MIT
// [GR eq. 1, 2, 5, 6] The equations of the injected pass written down plainly, on features that are really joined.
#pragma once

#include "support/matrix_module.hpp"

#include <genrender/attention/host_features.hpp>
#include <genrender/core/sparse_rows.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace genrender::testing {

/// Features of some tokens, a row each.
using token_rows = std::vector<std::vector<double>>;

/// The tokens of the frames of f that are named, one frame after the other: [f^i, f^j, ...].
template <class Real>
token_rows joined_rows(host_features<Real> const& f, std::vector<std::size_t> const& frames) {
    token_rows rows;
    auto const view = f.view();
    for (auto const i : frames) {
        for (std::size_t t = 0; t < f.extents()[1]; ++t) {
            auto& row = rows.emplace_back();
            for (std::size_t c = 0; c < f.extents()[2]; ++c) {
                row.push_back(static_cast<double>(view(i, t, c)));
            }
        }
    }
    return rows;
}

template <class Real>
token_rows dense_product(stack<Real, 2> const& W, token_rows const& f) {
    token_rows out;
    for (auto const& token : f) {
        auto& row = out.emplace_back();
        for (std::size_t r = 0; r < W.extent(0); ++r) {
            auto const* w = &W(r, 0);
            double sum = 0;
            for (auto const value : token) {
                sum += static_cast<double>(*w++) * value;
            }
            row.push_back(sum);
        }
    }
    return out;
}

/// F = Softmax(Q K^T / sqrt(d)) V of each head, with Q = W^Q f, K = W^K joined, V = W^V joined.
template <class Real>
token_rows dense_self_attention(matrix_module<Real> const& module, token_rows const& f, token_rows const& joined) {
    auto const Q = dense_product(module.W_Q, f);
    auto const K = dense_product(module.W_K, joined);
    auto const V = dense_product(module.W_V, joined);
    auto const channels = f[0].size();
    auto const d = channels / module.heads();
    token_rows F(f.size(), std::vector<double>(channels));
    for (std::size_t t = 0; t < f.size(); ++t) {
        for (std::size_t head = 0; head < module.heads(); ++head) {
            std::vector<double> exponentials;
            double sum = 0;
            for (auto const& k : K) {
                double logit = 0;
                auto const* const q_c = Q[t].data() + head * d;
                auto const* const k_c = k.data() + head * d;
                for (std::size_t c = 0; c < d; ++c) {
                    logit += q_c[c] * k_c[c];
                }
                exponentials.push_back(std::exp(logit / std::sqrt(static_cast<double>(d))));
                sum += exponentials.back();
            }
            for (std::size_t s = 0; s < V.size(); ++s) {
                auto const weight = exponentials[s] / sum;
                auto const* const v_c = V[s].data() + head * d;
                auto* const F_c = F[t].data() + head * d;
                for (std::size_t c = 0; c < d; ++c) {
                    F_c[c] += weight * v_c[c];
                }
            }
        }
    }
    return F;
}

/// F_out = alpha F_bar + (1 - alpha) F_hat at covered tokens, F_bar = rows * F_KF with the plan's matrix written out.
template <class Real>
token_rows dense_mix(token_rows F_hat, token_rows const& F_KF, sparse_rows<Real> const& rows, double alpha) {
    for (std::size_t t = 0; t < F_hat.size(); ++t) {
        std::vector<double> S(F_KF.size());
        for (auto e = rows.offsets[t]; e < rows.offsets[t + 1]; ++e) {
            S[rows.sources[e]] += static_cast<double>(rows.weights[e]);
        }
        for (std::size_t c = 0; c < F_hat[t].size() && rows.is_covered(t); ++c) {
            double F_bar = 0;
            for (std::size_t s = 0; s < S.size(); ++s) {
                F_bar += S[s] * F_KF[s][c];
            }
            F_hat[t][c] = alpha * F_bar + (1 - alpha) * F_hat[t][c];
        }
    }
    return F_hat;
}

/// The greatest difference between frame i of F and rows.
template <class Real>
double greatest_difference(host_features<Real> const& F, std::size_t i, token_rows const& rows) {
    double greatest = 0;
    auto const view = F.view();
    for (std::size_t t = 0; t < rows.size(); ++t) {
        for (std::size_t c = 0; c < rows[t].size(); ++c) {
            greatest = std::max(greatest, std::abs(static_cast<double>(view(i, t, c)) - rows[t][c]));
        }
    }
    return greatest;
}

/// Random features of N(0, 1) that their handle owns.
template <class Real>
host_features<Real> random_features(std::array<std::size_t, 3> const& extents, std::uint64_t seed) {
    auto const f = host_features<Real>::allocate(extents);
    auto const values = random_stack<Real, 3>(extents, seed);
    std::copy(values.data(), values.data() + values.size(), f.view().data());
    return f;
}

/// Whether two handles hold the same numbers, to the bit.
template <class Real>
bool equal_bits(host_features<Real> const& a, host_features<Real> const& b) {
    auto const* const begin = a.view().data();
    return a.extents() == b.extents() && std::equal(begin, begin + a.view().size(), b.view().data());
}

/// A made-up blend plan: every third token or so is not covered, the others mix one to three keyframe tokens with
/// weights that sum to 1.
template <class Real>
struct random_plan {
    std::vector<std::uint32_t> offsets{0};
    std::vector<std::uint32_t> sources;
    std::vector<Real> weights;

    random_plan(std::size_t tokens, std::size_t keyframes, std::uint64_t seed) {
        for (std::uint32_t t = 0; t < tokens; ++t) {
            auto const count = (1 + uniform_below(9, seed, random_stream::test, {t, 0, 1})) / 3; // 0 to 3
            for (std::uint32_t e = 0; e < count; ++e) {
                auto const source_count = static_cast<std::uint32_t>(keyframes * tokens);
                sources.push_back(uniform_below(source_count, seed, random_stream::test, {t, e, 2}));
                weights.push_back(static_cast<Real>(2 * e + 1) / static_cast<Real>(count * count));
            }
            offsets.push_back(static_cast<std::uint32_t>(sources.size()));
        }
    }
    sparse_rows<Real> rows() const { return {offsets, sources, weights}; }
};

} // namespace genrender::testing
