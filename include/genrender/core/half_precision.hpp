// SPDX-License-Identifier: MIT
// [IEEE 754-2019 sec. 3.6] The 16-bit storage formats of weights and features, to and from float.
#pragma once

#include <genrender/core/begin_header.inl>

#include <bit>
#include <cstdint>

namespace genrender {

/// The value of the binary16 number with these bits: exact; subnormal numbers, infinities and NaN included.
constexpr float float_of_half(std::uint16_t bits) {
    auto const sign = static_cast<std::uint32_t>(bits & 0x8000U) << 16;
    auto const exponent = static_cast<std::uint32_t>(bits >> 10) & 0x1FU;
    auto const mantissa = static_cast<std::uint32_t>(bits) & 0x3FFU;
    if (exponent == 0) {
        // A subnormal number is mantissa * 2^-24; the product is exact in float.
        auto const magnitude = static_cast<float>(mantissa) * 0x1p-24f;
        return std::bit_cast<float>(std::bit_cast<std::uint32_t>(magnitude) | sign);
    }
    auto const float_exponent = exponent == 0x1FU ? 0xFFU : exponent + (127 - 15);
    return std::bit_cast<float>(sign | (float_exponent << 23) | (mantissa << 13));
}

/// The value of the bfloat16 number with these bits, the upper half of a float: exact.
constexpr float float_of_bfloat16(std::uint16_t bits) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits) << 16);
}

/// The bits of the bfloat16 number nearest to `value`, ties to even; infinity beyond the greatest, NaN for NaN.
constexpr std::uint16_t bfloat16_of_float(float value) {
    auto const bits = std::bit_cast<std::uint32_t>(value);
    if ((bits & 0x7FFFFFFFU) > 0x7F800000U) {
        return static_cast<std::uint16_t>(bits >> 16 | 0x40U);
    }
    return static_cast<std::uint16_t>((bits + 0x7FFFU + (bits >> 16 & 1U)) >> 16);
}

/// The bits of the binary16 number nearest to `value`, ties to even; infinity from 65520 on, NaN for NaN.
constexpr std::uint16_t half_of_float(float value) {
    auto const bits = std::bit_cast<std::uint32_t>(value);
    auto const sign = static_cast<std::uint16_t>((bits >> 16) & 0x8000U);
    auto const magnitude = bits & 0x7FFFFFFFU;
    if (magnitude > 0x7F800000U) {
        return static_cast<std::uint16_t>(sign | 0x7E00U);
    }
    if (magnitude >= 0x477FF000U) {
        return static_cast<std::uint16_t>(sign | 0x7C00U);
    }
    if (magnitude < 0x38800000U) {
        // Below 2^-14: adding 0.5 leaves the subnormal mantissa, rounded to even, in the low bits of the sum.
        auto const shifted = std::bit_cast<float>(magnitude) + 0.5f;
        return static_cast<std::uint16_t>(sign | (std::bit_cast<std::uint32_t>(shifted) - 0x3F000000U));
    }
    auto const odd = (magnitude >> 13) & 1U;
    auto const rounded = magnitude - (std::uint32_t{127 - 15} << 23) + 0xFFFU + odd;
    return static_cast<std::uint16_t>(sign | (rounded >> 13));
}

} // namespace genrender

#include <genrender/core/end_header.inl>
