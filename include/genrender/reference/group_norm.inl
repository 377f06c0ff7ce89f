// SPDX-License-Identifier: MIT
// The moments of channels and what is made of them, with the vectors of one target.

namespace genrender::reference::internal::GENRENDER_TARGET {

using namespace genrender::detail::GENRENDER_TARGET_NAME;

// Sums of each channel and of its squares in double, in one pass: of what is left after the channel's first value, so
// that the squares do not drown in the mean.

template <std::size_t N, class Real>
void add_registers(double* sum, double* squares, strided_view<Real const, 2> const& in, std::size_t first) {
    constexpr auto lane = lane_count<double>;
    lanes<double> base[N];
    lanes<double> sums[N]{};
    lanes<double> products[N]{};
    unrolled<N>([&](auto i) GENRENDER_ALWAYS_INLINE { base[i] = load_widened<double>(in.data() + first + i * lane); });
    for (std::size_t token = 0; token < in.extent(0); ++token) {
        auto const* const x = in[token].data() + first;
        unrolled<N>([&](auto i) GENRENDER_ALWAYS_INLINE {
            auto const rest = load_widened<double>(x + i * lane) - base[i];
            sums[i] += rest;
            products[i] += rest * rest;
        });
    }
    unrolled<N>([&](auto i) GENRENDER_ALWAYS_INLINE {
        store(sum + first + i * lane, sums[i]);
        store(squares + first + i * lane, products[i]);
    });
}

template <class Real>
void add_channels(double* sum, double* squares, strided_view<Real const, 2> const& in, std::size_t first,
                  std::size_t last) {
    for (std::size_t token = 0; token < in.extent(0); ++token) {
        for (std::size_t c = first; c < last; ++c) {
            auto const rest = static_cast<double>(in(token, c)) - static_cast<double>(in(0, c));
            sum[c] += rest;
            squares[c] += rest * rest;
        }
    }
}

/// Writes the sums of channels [first, last) over all tokens of `in` [tokens, channels], of which there are some, into
/// `sum` and `squares` [channels]; those of channels that fill no register are added to what is there.
template <class Real>
void add_moments(double* sum, double* squares, strided_view<Real const, 2> in, std::size_t first, std::size_t last) {
    constexpr auto lane = lane_count<double>;
    /// Registers of sums at once.
    constexpr std::size_t most = many_vector_registers ? 8 : 4;
    auto c = first;
    for (; c + most * lane <= last; c += most * lane) {
        add_registers<most>(sum, squares, in, c);
    }
    for (; c + 4 * lane <= last; c += 4 * lane) {
        add_registers<4>(sum, squares, in, c);
    }
    for (; c + lane <= last; c += lane) {
        add_registers<1>(sum, squares, in, c);
    }
    add_channels(sum, squares, in, c, last);
}

/// Writes x scale + shift for all x of `in` [tokens, channels], or the SiLU of that. Factors may be read as far as a
/// register beyond the last channel.
template <bool WithSilu, class Real>
void apply_line(strided_view<Real, 2> out, strided_view<Real const, 2> in, Real const* scale, Real const* shift) {
    for (std::size_t token = 0; token < in.extent(0); ++token) {
        each_register(out[token].data(), in[token].data(), in.extent(1),
                      [&](std::size_t c, lanes<Real> const& x) GENRENDER_ALWAYS_INLINE {
                          auto const y = x * load(scale + c) + load(shift + c);
                          if constexpr (WithSilu) {
                              return silu_of<Real>(y);
                          } else {
                              return y;
                          }
                      });
    }
}

} // namespace genrender::reference::internal::GENRENDER_TARGET
