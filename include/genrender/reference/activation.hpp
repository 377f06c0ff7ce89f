// SPDX-License-Identifier: MIT
// The pointwise functions between layers: SiLU and the exact GELU.
#pragma once

#include <genrender/core/exponential.hpp>
#include <genrender/core/vector_lanes.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <type_traits>

namespace genrender::reference {

namespace internal {

using namespace genrender::detail;

/// Writes f(i, numbers from + i on, in one register) to `to` + i for all of `count` numbers. The last register overlaps
/// the one before it, so `f` must not ask where a number stands; `to` may be `from`.
template <class Real, class Function>
GENRENDER_ALWAYS_INLINE inline void each_register(Real* to, Real const* from, std::size_t count, Function const& f) {
    constexpr auto n = lane_count<Real>;
    if (count < n) {
        Real part[n] = {};
        std::copy_n(from, count, part);
        store(part, f(std::size_t{0}, load(part)));
        std::copy_n(part, count, to);
        return;
    }
    // Read before anything is written, for where both are the same memory.
    auto const last = load(from + count - n);
    std::size_t i = 0;
    for (; i + n <= count; i += n) {
        store(to + i, f(i, load(from + i)));
    }
    if (i < count) {
        store(to + count - n, f(count - n, last));
    }
}

/// x / (1 + exp(-x)).
template <class Real>
GENRENDER_ALWAYS_INLINE inline lanes<Real> silu_of(std::type_identity_t<lanes<Real>> x) {
    // 2^most is the largest power that is a number; where it stands for more, the result is next to 0 anyway.
    constexpr auto most = static_cast<Real>(std::numeric_limits<Real>::max_exponent - 2);
    auto const power = x * -std::numbers::log2e_v<Real>;
    return x / (Real{1} + exponential_2<Real>(power < spread(most) ? power : spread(most)));
}

/// Coefficients of Phi(-a) exp(a^2 / 2) as a polynomial in 1 / (1 + 0.23 a), the form of Hastings (1955), constant term
/// first; of relative error 5e-8 for 0 <= a <= 14, beyond which a Phi(-a) is 0 beside any number.
inline constexpr float normal_tail_coefficients[] = {
    -2.7762426515382843e-05F, 0.09237845640594139F,  0.08576291866935458F, 0.11951406232892241F, -0.03292023793728074F,
    0.3014729045096341F,      -0.27812710688396486F, 0.29041422052576993F, -0.07846747899825762F};

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

} // namespace internal

/// Replaces every x by x / (1 + exp(-x)). The result of an element does not depend on where in memory it lies.
template <class Real>
void silu(std::span<Real> values) {
    internal::each_register(values.data(), values.data(), values.size(),
                            [](std::size_t, auto x) GENRENDER_ALWAYS_INLINE { return internal::silu_of<Real>(x); });
}

/// Replaces every a by a b Phi(b), b being the element of `gates` in its place, with Phi the distribution function of
/// N(0, 1): gated by the GELU in its exact form (Hendrycks and Gimpel 2016). Both have the same size.
template <class Real>
void gate_by_gelu(std::span<Real> values, std::type_identity_t<std::span<Real const>> gates) {
    constexpr auto n = genrender::detail::lane_count<Real>;
    if (values.size() < n) {
        Real part[n] = {};
        std::copy_n(gates.data(), gates.size(), part);
        genrender::detail::store(part, internal::gelu_of<Real>(genrender::detail::load(part)));
        std::transform(values.begin(), values.end(), part, values.begin(), std::multiplies<Real>());
        return;
    }
    internal::each_register(values.data(), values.data(), values.size(),
                            [&](std::size_t i, auto a) GENRENDER_ALWAYS_INLINE {
                                return a * internal::gelu_of<Real>(genrender::detail::load(gates.data() + i));
                            });
}

/// x Phi(x).
template <class Real>
Real gelu(Real x) {
    Real result{1};
    gate_by_gelu<Real>({&result, 1}, {&x, 1});
    return result;
}

} // namespace genrender::reference
