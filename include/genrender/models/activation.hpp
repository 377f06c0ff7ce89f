// SPDX-License-Identifier: MIT
// The pointwise functions between layers: SiLU and the exact GELU.
#pragma once

#include <genrender/core/linalg.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

namespace genrender {

/// Replaces every x by x / (1 + exp(-x)). The result of an element does not depend on where in memory it lies.
template <class Real>
void silu(std::span<Real> values) {
    // Blocks of a fixed size in memory of their own, padded: else Eigen's exp and the one for the odd elements at the
    // ends, which differ in the last bit, would be chosen by the address.
    constexpr std::size_t block = 64;
    Eigen::Array<Real, block, 1> x = Eigen::Array<Real, block, 1>::Zero();
    for (std::size_t begin = 0; begin < values.size(); begin += block) {
        auto const count = std::min(block, values.size() - begin);
        std::copy_n(values.data() + begin, count, x.data());
        x = x / (1 + (-x).exp());
        std::copy_n(x.data(), count, values.data() + begin);
    }
}

/// x Phi(x), with Phi the distribution function of N(0, 1): the GELU in its exact form (Hendrycks and Gimpel 2016).
template <class Real>
Real gelu(Real x) {
    return x * Real(0.5) * (1 + std::erf(x / std::numbers::sqrt2_v<Real>));
}

} // namespace genrender
