// SPDX-License-Identifier: MIT
// [GR eq. 6] Post-attention injection: F_out = alpha F_bar + (1 - alpha) F_hat where keyframes cover a token.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/mix_rows_keeping_variance.hpp>
#include <genrender/core/finite.hpp>

#include <type_traits>

namespace genrender {

/// Replaces F_hat [tokens, channels] by F_out = alpha F_bar + (1 - alpha) F_hat, with F_bar = rows * F_KF and F_KF
/// [keyframes, tokens, channels]; a token that no keyframe covers keeps F_hat. F_hat is read once and written once,
/// F_bar is never in memory. alpha = 0 changes nothing. Throws shape_error if F_hat or F_KF do not fit, value_error if
/// alpha is not finite. What is told of `kept` variance is kept (mix_rows_keeping_variance).
template <class Real>
void post_attention(strided_view<Real, 2> F_hat, in_view<Real, 3> F_KF,
                    sparse_rows<std::type_identity_t<Real>> const& rows, std::type_identity_t<Real> alpha,
                    kept_variance const& kept = {}) {
    require_value(is_finite(alpha), "post_attention", "alpha", alpha, "a finite number");
    if (alpha == 0) {
        return;
    }
    mix_rows_keeping_variance(F_hat, F_KF, rows, alpha, kept);
}

/// The same with F_KF kept in 16 bits.
template <class Real, class Stored>
    requires half_storage<std::remove_const_t<Stored>>
void post_attention(strided_view<Real, 2> F_hat, strided_view<Stored, 3> F_KF,
                    sparse_rows<std::type_identity_t<Real>> const& rows, std::type_identity_t<Real> alpha,
                    kept_variance const& kept = {}) {
    require_value(is_finite(alpha), "post_attention", "alpha", alpha, "a finite number");
    if (alpha == 0) {
        return;
    }
    mix_rows_keeping_variance(F_hat, F_KF, rows, alpha, kept);
}

} // namespace genrender

#include <genrender/core/end_header.inl>
