// SPDX-License-Identifier: MIT
// Weighted sums of source rows with their moments, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

/// Rows of moments, a number a channel each, of deviations from the shift.
enum moment : std::size_t { sum_of_out, sum_of_squares_of_out, sum_of_squares_of_target, sum_of_target, moments };

/// The moments that a target has: the mean of what is averaged is that of F_out.
template <bool Total>
inline constexpr std::size_t moments_of = Total ? sum_of_target : moments;

/// The sources of one token that a pass takes, and what is left of the token's own feature.
template <class Real, class Stored>
struct token_sources {
    std::array<Stored const*, sources_a_pass> in;
    std::array<Real, sources_a_pass> weights; ///< times alpha
    std::size_t count;
    Real own;
    bool is_first; ///< pass of the token: `out` holds F_hat
    bool is_last;  ///< `out` will hold F_out
};

/// One number of mix_channels for `value(n)`, the sources' numbers at this channel, and what it adds to the moments.
template <bool Total, class Number, class Value>
GENRENDER_ALWAYS_INLINE inline Number mix_and_add(Number (&add)[moments], Number former, Number shift, auto const& pass,
                                                  Value const& value) {
    Number sum{};
    if (!pass.is_first || pass.own != 0) {
        sum = pass.is_first ? pass.own * former : former;
        if (Total && pass.is_first) {
            auto const d = former - shift;
            add[sum_of_squares_of_target] += pass.own * (d * d);
        }
    }
    for (std::size_t n = 0; n < pass.count; ++n) {
        Number const x = value(n);
        sum += pass.weights[n] * x;
        Number const d = x - shift;
        Number const weighted = pass.weights[n] * d;
        if constexpr (!Total) {
            add[sum_of_target] += weighted;
        }
        add[sum_of_squares_of_target] += weighted * d;
    }
    if (pass.is_last) {
        Number const d = sum - shift;
        add[sum_of_out] += d;
        add[sum_of_squares_of_out] += d * d;
    }
    return sum;
}

/// The channels of a token with neighbouring channels.
template <bool Total, class Real, class Stored>
void mix_and_add_channels(Real* out, Real* sums, Real const* shift, token_sources<Real, Stored> const& pass,
                          std::size_t channels) {
    constexpr auto width = lane_count<Real>;
    std::size_t c = 0;
    for (; c + width <= channels; c += width) {
        lanes<Real> add[moments];
        for (std::size_t m = 0; m < moments_of<Total>; ++m) {
            add[m] = load(sums + m * channels + c);
        }
        lanes<Real> former{};
        if (!pass.is_first || pass.own != 0) {
            former = load(out + c);
        }
        store(out + c, mix_and_add<Total>(add, former, load(shift + c), pass,
                                          [&](std::size_t n)
                                              GENRENDER_ALWAYS_INLINE { return load_widened<Real>(pass.in[n] + c); }));
        for (std::size_t m = 0; m < moments_of<Total>; ++m) {
            store(sums + m * channels + c, add[m]);
        }
    }
    for (; c < channels; ++c) {
        Real add[moments]{};
        out[c] = mix_and_add<Total>(add, out[c], shift[c], pass,
                                    [&](std::size_t n) { return static_cast<Real>(pass.in[n][c]); });
        for (std::size_t m = 0; m < moments; ++m) {
            sums[m * channels + c] += add[m];
        }
    }
}

/// mix_rows of tokens [begin, end), whose moments are added to `sums` [moments, channels]; returns how many are covered.
template <bool Total, class Real, class Stored>
std::size_t mix_and_sum_tokens(strided_view<Real, 2> F, strided_view<Stored const, 3> F_KF, sparse_rows<Real> rows,
                               Real alpha, Real const* shift, Real* sums, std::size_t begin, std::size_t end) {
    auto const channels = F.extent(1);
    auto const tokens = static_cast<std::uint32_t>(F_KF.extent(1));
    auto const is_contiguous = F.rows_are_contiguous() && F_KF.rows_are_contiguous();
    std::size_t covered = 0;
    for (auto t = begin; t < end; ++t) {
        std::size_t const last = rows.offsets[t + 1];
        covered += rows.offsets[t] < last ? 1U : 0U;
        for (std::size_t first = rows.offsets[t]; first < last; first += sources_a_pass) {
            token_sources<Real, Stored> pass;
            pass.count = std::min(last - first, sources_a_pass);
            pass.own = 1 - alpha;
            pass.is_first = first == rows.offsets[t];
            pass.is_last = first + pass.count == last;
            for (std::size_t n = 0; n < pass.count; ++n) {
                auto const source = rows.sources[first + n];
                pass.in[n] = F_KF.data() + static_cast<std::ptrdiff_t>(source / tokens) * F_KF.stride(0) +
                             static_cast<std::ptrdiff_t>(source % tokens) * F_KF.stride(1);
                pass.weights[n] = alpha * rows.weights[first + n];
            }
            if (is_contiguous) {
                mix_and_add_channels<Total>(F.data() + static_cast<std::ptrdiff_t>(t) * F.stride(0), sums, shift, pass,
                                            channels);
                continue;
            }
            for (std::size_t c = 0; c < channels; ++c) {
                Real add[moments]{};
                auto const at = static_cast<std::ptrdiff_t>(c) * F_KF.stride(2);
                F(t, c) = mix_and_add<Total>(add, F(t, c), shift[c], pass,
                                             [&](std::size_t n) { return static_cast<Real>(pass.in[n][at]); });
                for (std::size_t m = 0; m < moments; ++m) {
                    sums[m * channels + c] += add[m];
                }
            }
        }
    }
    return covered;
}

/// F[t] = gain * F[t] + offset, a channel each, for the covered of tokens [begin, end).
template <class Real>
void rescale_tokens(strided_view<Real, 2> F, sparse_rows<Real> rows, Real const* gain, Real const* offset,
                    std::size_t begin, std::size_t end) {
    constexpr auto width = lane_count<Real>;
    auto const channels = F.extent(1);
    for (auto t = begin; t < end; ++t) {
        if (rows.offsets[t] == rows.offsets[t + 1]) {
            continue;
        }
        std::size_t c = 0;
        if (F.rows_are_contiguous()) {
            auto* const out = F.data() + static_cast<std::ptrdiff_t>(t) * F.stride(0);
            for (; c + width <= channels; c += width) {
                store(out + c, load(gain + c) * load(out + c) + load(offset + c));
            }
        }
        for (; c < channels; ++c) {
            F(t, c) = gain[c] * F(t, c) + offset[c];
        }
    }
}

} // namespace genrender::detail::GENRENDER_TARGET
