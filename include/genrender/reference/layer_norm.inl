// SPDX-License-Identifier: MIT
// LayerNorm of some tokens, with the vectors of one target.

namespace genrender::reference::internal::GENRENDER_TARGET {

using namespace genrender::detail::GENRENDER_TARGET_NAME;

/// The sum of f(value): one sum a lane, then over the lanes, then over the values that fill no register.
template <class Real, class Function>
GENRENDER_ALWAYS_INLINE inline Real sum_of(Real const* values, std::size_t count, Function const& f) {
    constexpr auto n = lane_count<Real>;
    lanes<Real> sums{};
    std::size_t i = 0;
    for (; i + n <= count; i += n) {
        sums += f(load(values + i));
    }
    Real parts[n];
    store(parts, sums);
    for (auto half = n / 2; half > 0; half /= 2) {
        for (std::size_t lane = 0; lane < half; ++lane) {
            parts[lane] += parts[lane + half];
        }
    }
    for (; i < count; ++i) {
        parts[0] += f(values[i]);
    }
    return parts[0];
}

/// Writes the result [tokens, channels]; `weight` and `bias` may be read as far as a register beyond the last channel.
template <class Real>
void normalize_tokens(strided_view<Real, 2> out, strided_view<Real const, 2> in, Real const* weight, Real const* bias,
                      Real epsilon) {
    auto const channels = in.extent(1);
    for (std::size_t token = 0; token < in.extent(0); ++token) {
        auto const* const x = in[token].data();
        auto const mean = sum_of(x, channels, [](auto const& value) GENRENDER_ALWAYS_INLINE { return value; }) /
                          static_cast<Real>(channels);
        auto const squares = sum_of(x, channels, [&](auto const& value) GENRENDER_ALWAYS_INLINE {
            auto const rest = value - mean;
            return rest * rest;
        });
        auto const factor = 1 / std::sqrt(squares / static_cast<Real>(channels) + epsilon);
        each_register(out[token].data(), x, channels,
                      [&](std::size_t c, lanes<Real> const& value) GENRENDER_ALWAYS_INLINE {
                          return (value - mean) * factor * load(weight + c) + load(bias + c);
                      });
    }
}

} // namespace genrender::reference::internal::GENRENDER_TARGET
