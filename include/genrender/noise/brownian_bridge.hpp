// SPDX-License-Identifier: MIT
// White noise over an area, divided among parts of the area so that nothing of its statistics is lost.
#pragma once

#include <genrender/core/begin_header.inl>

#include <cstddef>
#include <span>

namespace genrender {

/// Turns independent values g of N(0, 1), one a part, into the values of the parts, given that the whole has the value
/// W: Y_j = g_j + sqrt(q_j) (W - sum_i sqrt(q_i) g_i). The shares q > 0 sum to 1. If W is of N(0, 1), the Y_j are
/// independent values of N(0, 1), and sum_j sqrt(q_j) Y_j = W: these are the increments of a Brownian bridge from 0 to
/// W, each scaled to unit variance (Deng et al., Infinite-Resolution Integral Noise Warping, ICLR 2025). `g` becomes Y.
inline void bridge(double W, std::span<double const> root_shares, std::span<double> g) {
    auto missing = W;
    for (std::size_t j = 0; j < g.size(); ++j) {
        missing -= root_shares[j] * g[j];
    }
    for (std::size_t j = 0; j < g.size(); ++j) {
        g[j] += root_shares[j] * missing;
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
