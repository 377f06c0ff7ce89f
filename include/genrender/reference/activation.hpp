// SPDX-License-Identifier: MIT
// The pointwise functions between layers: SiLU, the exact GELU and the sigmoid that stands for it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/vectors.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <type_traits>

namespace genrender::reference::internal {

/// Coefficients of Phi(-a) exp(a^2 / 2) as a polynomial in 1 / (1 + 0.23 a), the form of Hastings (1955), constant term
/// first; of relative error 5e-8 for 0 <= a <= 14, beyond which a Phi(-a) is 0 beside any number.
inline constexpr float normal_tail_coefficients[] = {
    -2.7762426515382843e-05F, 0.09237845640594139F,  0.08576291866935458F, 0.11951406232892241F, -0.03292023793728074F,
    0.3014729045096341F,      -0.27812710688396486F, 0.29041422052576993F, -0.07846747899825762F};

} // namespace genrender::reference::internal

#define GENRENDER_KERNELS <genrender/reference/activation.inl>
#include <genrender/core/each_target.inl>

namespace genrender::reference {

inline namespace GENRENDER_UNIT {

/// Replaces every x by x / (1 + exp(-x)). The result of an element does not depend on where in memory it lies.
template <class Real>
void silu(std::span<Real> values) {
    GENRENDER_KERNEL(internal, silu<Real>)(values.data(), values.size());
}

GENRENDER_INSTANCE(silu<float>);
GENRENDER_INSTANCE(silu<double>);

/// Replaces every a by a b Phi(b), b being the element of `gates` in its place, with Phi the distribution function of
/// N(0, 1): gated by the GELU in its exact form (Hendrycks and Gimpel 2016). Both have the same size.
template <class Real>
void gate_by_gelu(std::span<Real> values, std::type_identity_t<std::span<Real const>> gates) {
    GENRENDER_KERNEL(internal, gate_by_gelu<Real>)(values.data(), gates.data(), values.size());
}

GENRENDER_INSTANCE(gate_by_gelu<float>);
GENRENDER_INSTANCE(gate_by_gelu<double>);

/// Replaces every x by x / (1 + exp(-1.702 x)), which is close to GELU (Hendrycks and Gimpel 2016); CLIP calls it
/// quick_gelu.
template <class Real>
void quick_gelu(std::span<Real> values) {
    GENRENDER_KERNEL(internal, quick_gelu<Real>)(values.data(), values.size());
}

/// Replaces every x by x Phi(x), the GELU in its exact form.
template <class Real>
void gelu(std::span<Real> values) {
    GENRENDER_KERNEL(internal, gelu<Real>)(values.data(), values.size());
}

GENRENDER_INSTANCE(quick_gelu<float>);
GENRENDER_INSTANCE(quick_gelu<double>);

/// x Phi(x).
template <class Real>
    requires std::is_floating_point_v<Real> Real gelu(Real x) {
        Real result{1};
        gate_by_gelu<Real>({&result, 1}, {&x, 1});
        return result;
    }

} // namespace GENRENDER_UNIT

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
