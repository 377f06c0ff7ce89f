// SPDX-License-Identifier: MIT
// The consensus of clean estimates: x0_c <- mu + (sigma_src / sigma_mix) (R x0_c - mu) on the cells that a plan covers.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/mix_rows.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace genrender {

/// The estimates of source frames as plans read them: x0 [frames, channels, height, width] of one frame becomes
/// x0_src [tokens, channels], token = row * width + column. Throws shape_error if they do not fit.
template <class Real>
void gather_estimates(strided_view<Real, 2> x0_src, in_view<Real, 3> x0) {
    require_shape("gather_estimates", "x0_src", x0_src, {x0.extent(1) * x0.extent(2), x0.extent(0)});
    for (std::size_t c = 0; c < x0.extent(0); ++c) {
        for (std::size_t t = 0; t < x0_src.extent(0); ++t) {
            x0_src(t, c) = x0(c, t / x0.extent(2), t % x0.extent(2));
        }
    }
}

/// How much of the deviation of one channel averaging took: sigma_src / sigma_mix over the n covered cells,
/// sigma_mix^2 = sum_t (m_t - mu)^2 / n of the averages m_t = sum_e w_te x_te, and by the law of total variance
/// sigma_src^2 = sigma_mix^2 + sum_te w_te (x_te - m_t)^2 / n. At least 1, at most `most_gain`, and 1 where averages
/// are all alike. `mixed` and `x0_src` are of one channel, mixed [tokens], x0_src [sources, tokens].
template <class Real>
struct channel_consensus {
    Real mean = 0; ///< mu
    Real gain = 1; ///< sigma_src / sigma_mix

    /// Of the rows' averages `mixed` [tokens] and what they average, x0_src [sources, tokens]; rows cover some token.
    static channel_consensus of(in_view<Real, 1> mixed, in_view<Real, 2> x0_src, sparse_rows<Real> const& rows,
                                Real most_gain) {
        auto const tokens = mixed.extent(0);
        double sum = 0;
        double within = 0; // sums of n terms, in the order of tokens on any number of threads
        std::size_t covered = 0;
        for (std::size_t t = 0; t < tokens; ++t) {
            if (!rows.is_covered(t)) {
                continue;
            }
            ++covered;
            auto const average = static_cast<double>(mixed(t));
            sum += average;
            for (auto e = rows.offsets[t]; e < rows.offsets[t + 1]; ++e) {
                auto const source = rows.sources[e];
                auto const apart = static_cast<double>(x0_src(source / tokens, source % tokens)) - average;
                within += static_cast<double>(rows.weights[e]) * apart * apart;
            }
        }
        auto const mean = sum / static_cast<double>(covered);
        double between = 0;
        for (std::size_t t = 0; t < tokens; ++t) {
            if (rows.is_covered(t)) {
                auto const apart = static_cast<double>(mixed(t)) - mean;
                between += apart * apart;
            }
        }
        auto const gain = between > 0 ? std::sqrt(1 + within / between) : 1.0;
        return {static_cast<Real>(mean), static_cast<Real>(std::min(gain, static_cast<double>(most_gain)))};
    }
};

/// Moves the clean estimate x0 [channels, height, width] of a frame towards the consensus of x0_src [sources, tokens,
/// channels] (gather_estimates) along the frame's `rows`: where they cover a cell,
///     x0_c <- (1 - s) x0_c + s (mu + (sigma_src / sigma_mix) (R x0_c - mu)),   s = strength * shares / 255,
/// with the statistics of channel_consensus; elsewhere x0 stays. `shares` [height, width] are those of cell_shares.
/// Throws shape_error if extents do not fit, value_error for a strength outside of [0, 1] or a source beyond x0_src.
template <class Real>
void mix_consensus(strided_view<Real, 3> x0, in_view<Real, 3> x0_src,
                   sparse_rows<std::type_identity_t<Real>> const& rows, std::type_identity_t<Real> strength,
                   std::type_identity_t<Real> most_gain, strided_view<std::uint8_t const, 2> shares) {
    auto const channels = x0.extent(0);
    auto const width = x0.extent(2);
    auto const tokens = x0.extent(1) * width;
    require_shape("mix_consensus", "x0_src", x0_src, {x0_src.extent(0), tokens, channels});
    require_shape("mix_consensus", "shares", shares, {x0.extent(1), width});
    require_value(strength >= 0 && strength <= 1, "mix_consensus", "strength", strength, "a share in [0, 1]");
    require_value(most_gain >= 1, "mix_consensus", "most_gain", most_gain, "a factor of at least 1");
    auto mixed = stack<Real, 2>::uninitialized({tokens, channels});
    mix_rows(mixed.view(), x0_src, rows, Real{1});
    if (strength == 0 || rows.sources.empty()) {
        return;
    }
    auto const apart = static_cast<std::ptrdiff_t>(channels);
    for (std::size_t c = 0; c < channels; ++c) {
        in_view<Real, 1> const averages(std::as_const(mixed).data() + c, {tokens}, {apart});
        in_view<Real, 2> const of_sources(&x0_src(std::size_t{0}, std::size_t{0}, c), {x0_src.extent(0), tokens},
                                          {x0_src.stride(0), x0_src.stride(1)});
        auto const [mean, gain] = channel_consensus<Real>::of(averages, of_sources, rows, most_gain);
        for (std::size_t t = 0; t < tokens; ++t) {
            if (rows.is_covered(t)) {
                auto& value = x0(c, t / width, t % width);
                auto const s = strength * static_cast<Real>(shares(t / width, t % width)) / 255;
                value = (1 - s) * value + s * (mean + gain * (averages(t) - mean));
            }
        }
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
