// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The kernel of blending: applies a plan's sparse rows to recorded features, fused with the mix of eq. 6.
#pragma once

#include <genrender/core/sparse_rows.hpp>
#include <genrender/core/strided_view.hpp>

#include <cmath>
#include <cstddef>
#include <type_traits>

namespace genrender {

/// Where rows cover token t: F[t] = (1 - alpha) F[t] + alpha * sum of weights[e] * F_KF[sources[e]]; elsewhere F[t]
/// stays. F [tokens, channels]; F_KF [keyframes, tokens, channels], whose row k * tokens + t is source k * tokens + t.
/// Any strides; rows of neighbouring channels are fastest. With alpha = 1 the former F is not read. Throws
/// value_error for a source beyond F_KF, shape_error
/// if the channels or the rows do not fit.
template <class Real>
void mix_rows(strided_view<Real, 2> F, in_view<Real, 3> F_KF, sparse_rows<std::type_identity_t<Real>> const& rows,
              std::type_identity_t<Real> alpha) {
    auto const tokens = F.extent(0);
    auto const channels = F.extent(1);
    require_shape("mix_rows", "F_KF", F_KF, {F_KF.extent(0), F_KF.extent(1), channels});
    require_extents("mix_rows", "rows", std::array{rows.row_count()}, std::array{tokens});

    auto const source_rows = F_KF.extent(0) * F_KF.extent(1);
    for (auto const source : rows.sources) {
        require_value(source < source_rows, "mix_rows", "rows.sources", source,
                      "a row of the features' keyframes and tokens");
    }

    auto const source_tokens = F_KF.extent(1);
    auto const step = F.stride(1);
    auto const source_step = F_KF.stride(2);
    for (std::size_t t = 0; t < tokens; ++t) {
        auto const begin = rows.offsets[t];
        auto const end = rows.offsets[t + 1];
        if (begin == end) {
            continue;
        }
        auto* const out = &F(t, std::size_t{0});
        auto own = 1 - alpha;
        for (auto e = begin; e < end; ++e) {
            auto const source = rows.sources[e];
            auto const* const in = &F_KF(source / source_tokens, source % source_tokens, std::size_t{0});
            auto const weight = alpha * rows.weights[e];
            if (own == 0) {
                for (std::size_t c = 0; c < channels; ++c) {
                    out[static_cast<std::ptrdiff_t>(c) * step] =
                        weight * in[static_cast<std::ptrdiff_t>(c) * source_step];
                }
            } else if (step == 1 && source_step == 1) {
                for (std::size_t c = 0; c < channels; ++c) {
                    out[c] = own * out[c] + weight * in[c];
                }
            } else {
                for (std::size_t c = 0; c < channels; ++c) {
                    auto& value = out[static_cast<std::ptrdiff_t>(c) * step];
                    value = own * value + weight * in[static_cast<std::ptrdiff_t>(c) * source_step];
                }
            }
            // The own share enters with the first source only.
            own = 1;
        }
    }
}

} // namespace genrender
