// SPDX-License-Identifier: MIT
// 2^x of a whole register: a polynomial on half a unit either side of 0, and the whole part put into the exponent.
#pragma once

#include <genrender/core/vector_lanes.hpp>

#include <cstddef>
#include <limits>

namespace genrender::detail {

/// Coefficients of the polynomial of least relative error to 2^x on [-1/2, 1/2] that is 1 at 0 (Remez' algorithm, for
/// float then moved by a few last bits), constant term first: 3e-18 for double, and 1.5e-7 for float with all rounding.
template <class Real>
inline constexpr Real exponential_coefficients[] = {Real(1),
                                                    Real(0.69314718055994533046),
                                                    Real(0.24022650695910156205),
                                                    Real(0.055504108664819921483),
                                                    Real(0.0096181291075883350833),
                                                    Real(0.0013333558146789950323),
                                                    Real(0.00015403530462514613026),
                                                    Real(0.0000152527334899608046),
                                                    Real(1.3215433089594629037e-6),
                                                    Real(1.0178198033328527662e-7),
                                                    Real(7.0741056262456593708e-9),
                                                    Real(4.4352809446103361611e-10)};
template <>
inline constexpr float exponential_coefficients<float>[] = {
    1, 0.6931470036506653F, 0.24022242426872253F, 0.055507220327854156F, 0.009671498090028763F, 0.001326472731307149F};

/// 2^x in each lane for x < 127 (double: 1023), within about an ulp; what lies below the least normal number's
/// exponent counts as if it lay just above it, and NaN stays NaN.
template <class Real>
GENRENDER_ALWAYS_INLINE inline lanes<Real> exponential_2(std::type_identity_t<lanes<Real>> x) {
    using bits = typename vector_lanes<Real>::bits;
    constexpr auto mantissa = std::numeric_limits<Real>::digits - 1;
    constexpr auto least = static_cast<Real>(std::numeric_limits<Real>::min_exponent);
    // To a number of this size, half a unit is half of the last bit: adding it rounds x to whole numbers.
    constexpr auto rounder = static_cast<Real>(std::uint64_t{3} << (mantissa - 1));
    constexpr auto& c = exponential_coefficients<Real>;

    x = greater<Real>(spread(least), x);
    auto const whole = x + rounder;
    auto const rest = x - (whole - rounder);
    constexpr auto degree = sizeof c / sizeof *c - 1;
    auto power = spread(c[degree]);
    unrolled<degree>([&](auto i) GENRENDER_ALWAYS_INLINE { power = power * rest + c[degree - 1 - i]; });

    // The whole part stands in the last bits of `whole`.
    return bits_as<lanes<Real>>(bits_as<bits>(power) + (bits_as<bits>(whole) << mantissa));
}

} // namespace genrender::detail
