// SPDX-License-Identifier: MIT
// Eq. 6 that gives back the variance which averaging takes: one more sweep over F, none over F_KF.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/kept_variance.hpp>
#include <genrender/blending/mix_rows.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#define GENRENDER_KERNELS <genrender/blending/mix_rows_keeping_variance.inl>
#include <genrender/core/each_target.inl>

namespace genrender {

/// What deviations from the mean are multiplied by to turn a variance into another: sqrt(to / from), at most `most` and at
/// least 1 / most; 1 where there is nothing to rescale or to reach.
inline double variance_gain(double from, double to, double most) {
    // Of numbers that are alike but for rounding nothing is left to rescale.
    return from > 0 && to > 0 ? std::clamp(std::sqrt(to / from), 1 / most, most) : 1.0;
}

} // namespace genrender

namespace genrender::detail {

inline namespace GENRENDER_UNIT {

/// mix_rows_keeping_variance for features stored as any type.
template <class Real, class Stored>
void mix_stored_rows_keeping_variance(strided_view<Real, 2> F, strided_view<Stored const, 3> const& F_KF,
                                      sparse_rows<Real> const& rows, Real alpha, kept_variance const& kept,
                                      any_loop const& loop) {
    auto const tokens = F.extent(0);
    auto const channels = F.extent(1);
    constexpr std::size_t tokens_a_call = 256;
    auto const calls = (tokens + tokens_a_call - 1) / tokens_a_call;
    auto const each_call = [&](auto const& body) {
        loop(calls,
             [&](std::size_t call) { body(call, call * tokens_a_call, std::min((call + 1) * tokens_a_call, tokens)); });
    };

    // Moments are of deviations from some source, so that a mean far from 0 costs no digits.
    std::vector<Real> shift(channels);
    auto const source = rows.sources[rows.offsets[0]];
    for (std::size_t c = 0; c < channels; ++c) {
        shift[c] = static_cast<Real>(F_KF(source / F_KF.extent(1), source % F_KF.extent(1), c));
    }
    constexpr std::size_t moments = 4;
    std::vector<Real> sums(calls * moments * channels);
    std::vector<std::size_t> covered(calls);
    auto const is_total = kept.target == variance_target::total;
    auto const mix = is_total ? GENRENDER_KERNEL(detail, mix_and_sum_tokens<true, Real, Stored>)
                              : GENRENDER_KERNEL(detail, mix_and_sum_tokens<false, Real, Stored>);
    each_call([&](std::size_t call, std::size_t begin, std::size_t end) {
        covered[call] = mix(F, F_KF, rows, alpha, shift.data(), sums.data() + call * moments * channels, begin, end);
    });

    double count = 0;
    std::vector<double> all(moments * channels);
    for (std::size_t call = 0; call < calls; ++call) { // in this order, whatever the loop
        count += static_cast<double>(covered[call]);
        for (std::size_t i = 0; i < all.size(); ++i) {
            all[i] += double{sums[call * all.size() + i]};
        }
    }
    std::vector<Real> gain(channels);
    std::vector<Real> offset(channels);
    auto const weight = is_total ? count : count * double{alpha};
    for (std::size_t c = 0; c < channels; ++c) {
        auto const mean = all[c] / count;
        auto const mean_of_target = is_total ? mean : all[3 * channels + c] / weight;
        auto const from = all[channels + c] / count - mean * mean;
        auto const to = all[2 * channels + c] / weight - mean_of_target * mean_of_target;
        auto const g = count > 1 ? variance_gain(from, to, kept.most_gain) : 1.0;
        gain[c] = static_cast<Real>(g);
        offset[c] = static_cast<Real>((1 - g) * (double{shift[c]} + mean));
    }
    auto const rescale = GENRENDER_KERNEL(detail, rescale_tokens<Real>);
    each_call([&](std::size_t, std::size_t begin, std::size_t end) {
        rescale(F, rows, gain.data(), offset.data(), begin, end);
    });
}

/// Checks what is given, and leaves what there is nothing to keep of to mix_rows.
template <class Real, class Stored>
void mix_rows_as_told(strided_view<Real, 2> F, strided_view<Stored const, 3> const& F_KF, sparse_rows<Real> const& rows,
                      Real alpha, kept_variance const& kept, any_loop const& loop) {
    require_kept_variance("mix_rows_keeping_variance", kept);
    if (kept.target == variance_target::none || alpha == 0 || rows.sources.empty() || F.extent(1) == 0) {
        mix_stored_rows(F, F_KF, rows, alpha, loop);
        return;
    }
    require_mixable("mix_rows_keeping_variance", F, F_KF, rows);
    mix_stored_rows_keeping_variance(F, F_KF, rows, alpha, kept, loop);
}

GENRENDER_INSTANCE(mix_rows_as_told<float, float>);
GENRENDER_INSTANCE(mix_rows_as_told<float, float16_bits>);
GENRENDER_INSTANCE(mix_rows_as_told<float, bfloat16_bits>);
GENRENDER_INSTANCE(mix_rows_as_told<double, double>);

} // namespace GENRENDER_UNIT

} // namespace genrender::detail

namespace genrender {

inline namespace GENRENDER_UNIT {

/// mix_rows, after which the covered tokens' deviations from their mean are rescaled in each channel:
///     F[t] = m + g (F[t] - m),    g = S / s in [1 / most_gain, most_gain]
/// with m and s^2 mean and variance of F_out over the covered tokens. With X_j the features that token t mixes, F_hat[t]
/// and its sources, and v_j their shares, 1 - alpha and alpha * weights[e], S^2 is
///     variance_target::total      mean over t of the sum of v_j (X_j - m)^2
///                                 = s^2 + mean over t of the sum of v_j (X_j - F_out[t])^2,
/// the law of total variance: what averaging took is the second term, so that g >= 1; and
///     variance_target::sources    the variance of F_KF[sources[e]] by weights[e].
/// Means are those of eq. 6. One sweep mixes and sums moments, one more over F rescales. The result does not depend on
/// `loop`, to the last bit. A target of none, and alpha = 0, give what mix_rows gives. F is one frame; all else as in
/// mix_rows, which it throws as; also value_error for a most_gain below 1.
template <class Real>
void mix_rows_keeping_variance(strided_view<Real, 2> F, in_view<Real, 3> F_KF,
                               sparse_rows<std::type_identity_t<Real>> const& rows, std::type_identity_t<Real> alpha,
                               kept_variance const& kept, any_loop const& loop = {}) {
    detail::mix_rows_as_told<Real, Real>(F, F_KF, rows, alpha, kept, loop);
}

/// The same from features stored in 16 bits; arithmetic is done in `Real`.
template <class Real, class Stored>
    requires half_storage<Stored>
void mix_rows_keeping_variance(strided_view<Real, 2> F, strided_view<Stored, 3> F_KF,
                               sparse_rows<std::type_identity_t<Real>> const& rows, std::type_identity_t<Real> alpha,
                               kept_variance const& kept, any_loop const& loop = {}) {
    detail::mix_rows_as_told(F, to_bits_view(F_KF), rows, alpha, kept, loop);
}

} // namespace GENRENDER_UNIT

} // namespace genrender

#include <genrender/core/end_header.inl>
