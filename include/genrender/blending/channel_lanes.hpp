// SPDX-License-Identifier: MIT
// Neighbouring channels as one register of the target, and 16-bit storage widened on its way into it.
#pragma once

#include <genrender/core/linalg.hpp>
#include <genrender/core/register_vector.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#if defined(__GNUC__) && (defined(__AVX2__) || defined(__F16C__))
#include <immintrin.h>
#elif defined(__GNUC__) && defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace genrender {

/// Types in which features may be stored besides the scalar that computes with them.
template <class Stored>
concept half_storage = std::same_as<Stored, float16> || std::same_as<Stored, bfloat16>;

namespace detail {

#if defined(__GNUC__)

/// `Count` elements of 16 bits in the lower halves of 32.
template <std::size_t Count, half_storage Stored>
register_vector<std::uint32_t, Count> bits_of(Stored const* from) {
    using bits = register_vector<std::uint32_t, Count>;
    // Some compilers take four instructions to widen a register and put it together again where there is one.
#if defined(__AVX512F__)
    if constexpr (Count == 16) {
        return bits_as<bits>(_mm512_maskz_cvtepu16_epi32(0xFFFF, load_as<__m256i>(from)));
    }
#endif
#if defined(__AVX2__)
    if constexpr (Count == 8) {
        return bits_as<bits>(_mm256_cvtepu16_epi32(load_as<__m128i>(from)));
    }
#endif
#if defined(__SSE2__)
    if constexpr (Count == 4) {
        auto const half = _mm_loadl_epi64(reinterpret_cast<__m128i const*>(from));
        return bits_as<bits>(_mm_unpacklo_epi16(half, _mm_setzero_si128()));
    }
#endif
    return __builtin_convertvector((load_as<register_vector<std::uint16_t, Count>>(from)), bits);
}

/// `Count` values of bfloat16 as floats.
template <std::size_t Count>
register_vector<float, Count> widened(bfloat16 const* from) {
    return bits_as<register_vector<float, Count>>(bits_of<Count>(from) << 16);
}

/// `Count` values of binary16 as floats.
template <std::size_t Count>
register_vector<float, Count> widened(float16 const* from) {
#if defined(__AVX512F__)
    if constexpr (Count == 16) {
        // Masked, because the plain one makes some compilers warn about a register of its own.
        return _mm512_maskz_cvtph_ps(0xFFFF, load_as<__m256i>(from));
    }
#endif
#if defined(__F16C__)
    if constexpr (Count == 8) {
        return _mm256_cvtph_ps(load_as<__m128i>(from));
    }
#endif
    using floats = register_vector<float, Count>;
    using bits = register_vector<std::uint32_t, Count>;
    auto const half = bits_of<Count>(from);
    // Exponent and mantissa go to where a float has them, and the product moves the exponent's bias, of numbers too
    // small for a full mantissa too. Exponents of all ones are infinities and not-a-numbers.
    auto const magnitude = half & 0x7FFFU;
    auto const moved = bits_as<bits>(bits_as<floats>(magnitude << 13) * 0x1p112F);
    auto const special = bits_as<bits>(magnitude >= 0x7C00U) & 0x7F800000U;
    return bits_as<floats>(moved | special | (half & 0x8000U) << 16);
}

/// As many neighbouring channels of `Real` as a register holds.
template <class Real>
struct channel_lanes {
    static constexpr std::size_t count = register_lanes<Real>;
    using type = register_vector<Real>;

    template <class Stored>
    static type load(Stored const* from) {
        if constexpr (std::same_as<Stored, Real>) {
            return load_as<type>(from);
        } else {
            return __builtin_convertvector(widened<count>(from), type);
        }
    }
    static void store(Real* to, type const& value) { std::memcpy(to, &value, sizeof(value)); }
};

#else

template <class Real>
struct channel_lanes {
    static constexpr std::size_t count = 1;
    using type = Real;

    template <class Stored>
    static type load(Stored const* from) {
        return static_cast<Real>(*from);
    }
    static void store(Real* to, type value) { *to = value; }
};

#endif

} // namespace detail

} // namespace genrender
