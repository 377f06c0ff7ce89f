// SPDX-License-Identifier: MIT
// Sums of factors times numbers, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

/// out[e] = sum over n of factors[n] * in[n][e].
template <class Real, std::size_t Terms>
void combine(Real* out, std::size_t count, std::array<Real, Terms> factors, std::array<Real const*, Terms> in) {
    std::size_t e = 0;
    for (; e + lane_count<Real> <= count; e += lane_count<Real>) {
        auto sum = factors[0] * load(in[0] + e);
        unrolled<Terms - 1>([&](auto less_one)
                                GENRENDER_ALWAYS_INLINE { sum += factors[less_one + 1] * load(in[less_one + 1] + e); });
        store(out + e, sum);
    }
    for (; e < count; ++e) {
        auto sum = factors[0] * in[0][e];
        unrolled<Terms - 1>([&](auto less_one)
                                GENRENDER_ALWAYS_INLINE { sum += factors[less_one + 1] * in[less_one + 1][e]; });
        out[e] = sum;
    }
}

} // namespace genrender::detail::GENRENDER_TARGET
