// SPDX-License-Identifier: MIT
// Weighted sums of source rows, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

/// out[c] = own * out[c] + sum over n of weights[n] * in[n][c]. `out` is not read unless `ReadsOut`.
template <bool ReadsOut, class Real, class Stored, std::size_t Count>
void mix_channels(Real* out, std::array<Stored const*, Count> const& in, std::array<Real, Count> const& weights,
                  Real own, std::size_t channels) {
    constexpr auto width = lane_count<Real>;
    std::size_t c = 0;
    for (; c + width <= channels; c += width) {
        lanes<Real> sum{};
        if constexpr (ReadsOut) {
            sum = own * load(out + c);
            sum += weights[0] * load_widened<Real>(in[0] + c);
        } else {
            sum = weights[0] * load_widened<Real>(in[0] + c);
        }
        for (std::size_t n = 1; n < Count; ++n) {
            sum += weights[n] * load_widened<Real>(in[n] + c);
        }
        store(out + c, sum);
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

/// mix_rows of tokens [begin, end).
template <class Real, class Stored>
void mix_tokens(strided_view<Real, 2> F, strided_view<Stored const, 3> F_KF, sparse_rows<Real> rows, Real alpha,
                std::size_t begin, std::size_t end) {
    auto const channels = F.extent(1);
    auto const is_contiguous = F.rows_are_contiguous() && F_KF.rows_are_contiguous();
    for (auto t = begin; t < end; ++t) {
        auto const first = rows.offsets[t];
        std::size_t const count = rows.offsets[t + 1] - first;
        if (count == 0) {
            continue;
        }
        auto const sources = rows.sources.subspan(first, count);
        auto const shares = rows.weights.subspan(first, count);
        if (is_contiguous) {
            mix_row(F.data() + static_cast<std::ptrdiff_t>(t) * F.stride(0), F_KF, sources, shares, alpha, channels);
        } else {
            mix_strided_row(F[t], F_KF, sources, shares, alpha);
        }
    }
}

} // namespace genrender::detail::GENRENDER_TARGET
