// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The kernel of blending: applies a plan's sparse rows to recorded features, fused with the mix of eq. 6.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/half_storage.hpp>
#include <genrender/core/instance.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/vectors.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace genrender::detail {

/// Sources that one pass over the channels of a row takes; the few rows that have more take several passes.
inline constexpr std::size_t sources_a_pass = 8;

} // namespace genrender::detail

#define GENRENDER_KERNELS <genrender/blending/mix_rows.inl>
#include <genrender/core/each_target.inl>

namespace genrender::detail {

inline namespace GENRENDER_UNIT {

/// Throws, in the name of `function`, for features and rows that do not fit.
template <class Real, class Stored>
void require_mixable(char const* function, strided_view<Real, 2> const& F, strided_view<Stored const, 3> const& F_KF,
                     sparse_rows<Real> const& rows) {
    require_shape(function, "F_KF", F_KF, {F_KF.extent(0), F_KF.extent(1), F.extent(1)});
    if (rows.row_count() != F.extent(0)) {
        require_extents(function, "rows", std::array{rows.row_count()}, std::array{F.extent(0)});
    }
    if (!rows.sources.empty()) {
        // One comparison in all: the greatest source.
        std::uint32_t greatest = 0;
        for (auto const source : rows.sources) {
            greatest = std::max(greatest, source);
        }
        require_value(greatest < F_KF.extent(0) * F_KF.extent(1), function, "rows.sources", greatest,
                      "a row of the features' keyframes and tokens");
    }
}

/// mix_rows for features stored as any type.
template <class Real, class Stored>
void mix_stored_rows(strided_view<Real, 2> F, strided_view<Stored const, 3> const& F_KF, sparse_rows<Real> const& rows,
                     Real alpha, any_loop const& loop) {
    require_mixable("mix_rows", F, F_KF, rows);
    auto const tokens = F.extent(0);
    auto const mix = GENRENDER_KERNEL(detail, mix_tokens<Real, Stored>);
    constexpr std::size_t tokens_a_call = 256;
    loop((tokens + tokens_a_call - 1) / tokens_a_call, [&](std::size_t call) {
        mix(F, F_KF, rows, alpha, call * tokens_a_call, std::min((call + 1) * tokens_a_call, tokens));
    });
}

GENRENDER_INSTANCE(mix_stored_rows<float, float>);
GENRENDER_INSTANCE(mix_stored_rows<float, float16_bits>);
GENRENDER_INSTANCE(mix_stored_rows<float, bfloat16_bits>);
GENRENDER_INSTANCE(mix_stored_rows<double, double>);

} // namespace GENRENDER_UNIT

} // namespace genrender::detail

namespace genrender {

inline namespace GENRENDER_UNIT {

/// Where rows cover token t: F[t] = (1 - alpha) F[t] + alpha * sum of weights[e] * F_KF[sources[e]]; elsewhere F[t]
/// stays. F [tokens, channels]; F_KF [keyframes, tokens, channels], whose row k * tokens + t is source k * tokens + t.
/// Any strides; rows of neighbouring channels are fastest: each is read once and written once, all of its sources
/// beside each other. With alpha = 1 the former F is not read. Tokens run through `loop`. Throws value_error for a
/// source beyond F_KF, shape_error if the channels or the rows do not fit.
template <class Real>
void mix_rows(strided_view<Real, 2> F, in_view<Real, 3> F_KF, sparse_rows<std::type_identity_t<Real>> const& rows,
              std::type_identity_t<Real> alpha, any_loop const& loop = {}) {
    detail::mix_stored_rows<Real, Real>(F, F_KF, rows, alpha, loop);
}

/// The same from features stored in 16 bits; arithmetic is done in `Real`.
template <class Real, class Stored>
    requires half_storage<Stored>
void mix_rows(strided_view<Real, 2> F, strided_view<Stored, 3> F_KF,
              sparse_rows<std::type_identity_t<Real>> const& rows, std::type_identity_t<Real> alpha,
              any_loop const& loop = {}) {
    detail::mix_stored_rows(F, to_bits_view(F_KF), rows, alpha, loop);
}

} // namespace GENRENDER_UNIT

} // namespace genrender

#include <genrender/core/end_header.inl>
