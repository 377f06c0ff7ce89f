// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The kernel of blending: applies a plan's sparse rows to recorded features, fused with the mix of eq. 6.
#pragma once

#include <genrender/blending/channel_lanes.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

namespace genrender {

namespace detail {

/// Sources that one pass over the channels of a row takes; the few rows that have more take several passes.
inline constexpr std::size_t sources_a_pass = 8;

/// out[c] = own * out[c] + sum over n of weights[n] * in[n][c]. `out` is not read unless `ReadsOut`.
template <bool ReadsOut, class Real, class Stored, std::size_t Count>
void mix_channels(Real* out, std::array<Stored const*, Count> const& in, std::array<Real, Count> const& weights,
                  Real own, std::size_t channels) {
    using lanes = channel_lanes<Real>;
    std::size_t c = 0;
    for (; c + lanes::count <= channels; c += lanes::count) {
        auto sum = typename lanes::type{};
        if constexpr (ReadsOut) {
            sum = own * lanes::load(out + c);
            sum += weights[0] * lanes::load(in[0] + c);
        } else {
            sum = weights[0] * lanes::load(in[0] + c);
        }
        for (std::size_t n = 1; n < Count; ++n) {
            sum += weights[n] * lanes::load(in[n] + c);
        }
        lanes::store(out + c, sum);
    }
    for (; c < channels; ++c) {
        auto sum = weights[0] * static_cast<Real>(in[0][c]);
        if constexpr (ReadsOut) {
            sum = own * out[c];
            sum += weights[0] * static_cast<Real>(in[0][c]);
        }
        for (std::size_t n = 1; n < Count; ++n) {
            sum += weights[n] * static_cast<Real>(in[n][c]);
        }
        out[c] = sum;
    }
}

/// Calls mix_channels for the number of sources at hand.
template <std::size_t Count = 1, class Real, class Stored>
void mix_channels_of(Real* out, Stored const* const* in, Real const* weights, std::size_t count, Real own,
                     std::size_t channels) {
    if constexpr (Count < sources_a_pass) {
        if (count > Count) {
            mix_channels_of<Count + 1>(out, in, weights, count, own, channels);
            return;
        }
    }
    std::array<Stored const*, Count> rows;
    std::array<Real, Count> shares;
    std::copy_n(in, Count, rows.begin());
    std::copy_n(weights, Count, shares.begin());
    if (own == 0) {
        mix_channels<false>(out, rows, shares, own, channels);
    } else {
        mix_channels<true>(out, rows, shares, own, channels);
    }
}

/// One row of mix_rows with neighbouring channels.
template <class Real, class Stored>
void mix_row(Real* out, strided_view<Stored const, 3> const& F_KF, std::span<std::uint32_t const> sources,
             std::span<Real const> shares, Real alpha, std::size_t channels) {
    auto const keyframe_stride = F_KF.stride(0);
    auto const token_stride = F_KF.stride(1);
    auto const tokens = static_cast<std::uint32_t>(F_KF.extent(1));
    std::array<Stored const*, sources_a_pass> in;
    std::array<Real, sources_a_pass> weights;
    // The own share enters with the first pass only.
    auto own = 1 - alpha;
    for (std::size_t first = 0; first < sources.size(); first += sources_a_pass) {
        auto const count = std::min(sources.size() - first, sources_a_pass);
        for (std::size_t n = 0; n < count; ++n) {
            auto const source = sources[first + n];
            in[n] = F_KF.data() + static_cast<std::ptrdiff_t>(source / tokens) * keyframe_stride +
                    static_cast<std::ptrdiff_t>(source % tokens) * token_stride;
            weights[n] = alpha * shares[first + n];
        }
        mix_channels_of(out, in.data(), weights.data(), count, own, channels);
        own = 1;
    }
}

/// The same at any strides, channel by channel.
template <class Real, class Stored>
void mix_strided_row(strided_view<Real, 1> out, strided_view<Stored const, 3> const& F_KF,
                     std::span<std::uint32_t const> sources, std::span<Real const> shares, Real alpha) {
    for (std::size_t c = 0; c < out.extent(0); ++c) {
        auto const at = [&](std::size_t n) {
            return static_cast<Real>(F_KF(sources[n] / F_KF.extent(1), sources[n] % F_KF.extent(1), c));
        };
        auto const first_weight = alpha * shares[0];
        auto sum = first_weight * at(0);
        if (alpha != 1) {
            sum = (1 - alpha) * out(c);
            sum += first_weight * at(0);
        }
        for (std::size_t n = 1; n < sources.size(); ++n) {
            auto const weight = alpha * shares[n];
            sum += weight * at(n);
        }
        out(c) = sum;
    }
}

/// mix_rows for features stored as any type.
template <class Real, class Stored, class Loop>
void mix_stored_rows(strided_view<Real, 2> F, strided_view<Stored const, 3> const& F_KF, sparse_rows<Real> const& rows,
                     Real alpha, Loop const& loop) {
    auto const tokens = F.extent(0);
    auto const channels = F.extent(1);
    require_shape("mix_rows", "F_KF", F_KF, {F_KF.extent(0), F_KF.extent(1), channels});
    if (rows.row_count() != tokens) {
        require_extents("mix_rows", "rows", std::array{rows.row_count()}, std::array{tokens});
    }
    if (!rows.sources.empty()) {
        // One comparison in all: the greatest source.
        std::uint32_t greatest = 0;
        for (auto const source : rows.sources) {
            greatest = std::max(greatest, source);
        }
        require_value(greatest < F_KF.extent(0) * F_KF.extent(1), "mix_rows", "rows.sources", greatest,
                      "a row of the features' keyframes and tokens");
    }

    auto const is_contiguous = F.rows_are_contiguous() && F_KF.rows_are_contiguous();
    constexpr std::size_t tokens_a_call = 256;
    loop((tokens + tokens_a_call - 1) / tokens_a_call, [&](std::size_t call) {
        auto const end = std::min((call + 1) * tokens_a_call, tokens);
        for (auto t = call * tokens_a_call; t < end; ++t) {
            auto const begin = rows.offsets[t];
            std::size_t const count = rows.offsets[t + 1] - begin;
            if (count == 0) {
                continue;
            }
            auto const sources = rows.sources.subspan(begin, count);
            auto const shares = rows.weights.subspan(begin, count);
            if (is_contiguous) {
                mix_row(F.data() + static_cast<std::ptrdiff_t>(t) * F.stride(0), F_KF, sources, shares, alpha,
                        channels);
            } else {
                mix_strided_row(F[t], F_KF, sources, shares, alpha);
            }
        }
    });
}

} // namespace detail

/// Where rows cover token t: F[t] = (1 - alpha) F[t] + alpha * sum of weights[e] * F_KF[sources[e]]; elsewhere F[t]
/// stays. F [tokens, channels]; F_KF [keyframes, tokens, channels], whose row k * tokens + t is source k * tokens + t.
/// Any strides; rows of neighbouring channels are fastest: each is read once and written once, all of its sources
/// beside each other. With alpha = 1 the former F is not read. Tokens run through `loop`. Throws value_error for a
/// source beyond F_KF, shape_error if the channels or the rows do not fit.
template <class Real, parallel_loop Loop = sequential_loop>
void mix_rows(strided_view<Real, 2> F, in_view<Real, 3> F_KF, sparse_rows<std::type_identity_t<Real>> const& rows,
              std::type_identity_t<Real> alpha, Loop const& loop = {}) {
    detail::mix_stored_rows(F, F_KF, rows, alpha, loop);
}

/// The same from features stored in 16 bits; arithmetic is done in `Real`.
template <class Real, class Stored, parallel_loop Loop = sequential_loop>
    requires half_storage<std::remove_const_t<Stored>>
void mix_rows(strided_view<Real, 2> F, strided_view<Stored, 3> F_KF,
              sparse_rows<std::type_identity_t<Real>> const& rows, std::type_identity_t<Real> alpha,
              Loop const& loop = {}) {
    detail::mix_stored_rows(F, strided_view<std::remove_const_t<Stored> const, 3>(F_KF), rows, alpha, loop);
}

} // namespace genrender
