// SPDX-License-Identifier: MIT
// SiLU, GELU and its stand-in, with the vectors of one target.

namespace genrender::reference::internal::GENRENDER_TARGET {

using namespace genrender::detail::GENRENDER_TARGET_NAME;

/// x / (1 + exp(-x)).
template <class Real>
GENRENDER_ALWAYS_INLINE inline lanes<Real> silu_of(std::type_identity_t<lanes<Real>> x) {
    // 2^most is the largest power that is a number; where it stands for more, the result is next to 0 anyway.
    constexpr auto most = static_cast<Real>(std::numeric_limits<Real>::max_exponent - 2);
    auto const power = x * -std::numbers::log2e_v<Real>;
    return x / (Real{1} + exponential_2<Real>(power < spread(most) ? power : spread(most)));
}

/// x Phi(x), within about an ulp of the greater of x and gelu(x).
template <class Real>
GENRENDER_ALWAYS_INLINE inline lanes<Real> gelu_of(std::type_identity_t<lanes<Real>> x) {
    if constexpr (std::is_same_v<Real, float>) {
        auto const a = x < lanes<float>{} ? -x : x;
        auto const t = 1.0F / (1.0F + 0.23F * a);
        constexpr auto& c = normal_tail_coefficients;
        auto tail = spread(c[8]);
        unrolled<8>([&](auto i) GENRENDER_ALWAYS_INLINE { tail = tail * t + c[7 - i]; });
        tail *= exponential_2<float>(a * a * (-0.5F * std::numbers::log2e_v<float>));
        return (x < lanes<float>{} ? lanes<float>{} : x) - a * tail;
    } else {
        Real numbers[lane_count<Real>];
        store(numbers, x);
        for (auto& number : numbers) {
            number = number * Real(0.5) * (1 + std::erf(number / std::numbers::sqrt2_v<Real>));
        }
        return load(numbers);
    }
}

/// See silu in reference/activation.hpp.
template <class Real>
void silu(Real* values, std::size_t count) {
    each_register(values, values, count,
                  [](std::size_t, auto const& x) GENRENDER_ALWAYS_INLINE { return silu_of<Real>(x); });
}

/// See quick_gelu in reference/activation.hpp.
template <class Real>
void quick_gelu(Real* values, std::size_t count) {
    constexpr auto slope = static_cast<Real>(1.702);
    each_register(values, values, count, [](std::size_t, auto const& x) GENRENDER_ALWAYS_INLINE {
        return silu_of<Real>(x * slope) * (1 / slope);
    });
}

/// See gelu in reference/activation.hpp.
template <class Real>
void gelu(Real* values, std::size_t count) {
    each_register(values, values, count,
                  [](std::size_t, auto const& x) GENRENDER_ALWAYS_INLINE { return gelu_of<Real>(x); });
}

/// See gate_by_gelu in reference/activation.hpp.
template <class Real>
void gate_by_gelu(Real* values, Real const* gates, std::size_t count) {
    constexpr auto n = lane_count<Real>;
    if (count < n) {
        Real part[n] = {};
        std::copy_n(gates, count, part);
        store(part, gelu_of<Real>(load(part)));
        std::transform(values, values + count, part, values, std::multiplies<Real>());
        return;
    }
    each_register(values, values, count, [&](std::size_t i, lanes<Real> const& a) GENRENDER_ALWAYS_INLINE {
        return a * gelu_of<Real>(load(gates + i));
    });
}

} // namespace genrender::reference::internal::GENRENDER_TARGET
