// SPDX-License-Identifier: MIT
// Registers of numbers that are kept in 16 bits, with the vectors of one target.

namespace genrender::detail::GENRENDER_TARGET {

#if defined(__GNUC__)

/// `Count` elements of 16 bits in the lower halves of 32.
template <std::size_t Count>
GENRENDER_ALWAYS_INLINE inline lanes<std::uint32_t, Count> half_words(void const* from) {
    using words = lanes<std::uint32_t, Count>;
    // Some compilers take four instructions to widen a register and put it together again where there is one.
#if GENRENDER_TARGET_AVX512
    if constexpr (Count == 16) {
        return bits_as<words>(_mm512_maskz_cvtepu16_epi32(0xFFFF, load_as<__m256i>(static_cast<char const*>(from))));
    }
#endif
#if GENRENDER_TARGET_AVX2
    if constexpr (Count == 8) {
        return bits_as<words>(_mm256_cvtepu16_epi32(load_as<__m128i>(static_cast<char const*>(from))));
    }
#endif
#if defined(__SSE2__)
    if constexpr (Count == 4) {
        auto const half = _mm_loadl_epi64(static_cast<__m128i const*>(from));
        return bits_as<words>(_mm_unpacklo_epi16(half, _mm_setzero_si128()));
    }
#endif
    return __builtin_convertvector((load_as<lanes<std::uint16_t, Count>>(static_cast<char const*>(from))), words);
}

/// `Count` values of bfloat16 as floats.
template <std::size_t Count>
GENRENDER_ALWAYS_INLINE inline lanes<float, Count> widened(bfloat16_bits const* from) {
    return bits_as<lanes<float, Count>>(half_words<Count>(from) << 16);
}

/// `Count` values of binary16 as floats.
template <std::size_t Count>
GENRENDER_ALWAYS_INLINE inline lanes<float, Count> widened(float16_bits const* from) {
#if GENRENDER_TARGET_AVX512
    if constexpr (Count == 16) {
        // Masked, because the plain one makes some compilers warn about a register of its own.
        return _mm512_maskz_cvtph_ps(0xFFFF, load_as<__m256i>(from));
    }
#endif
#if GENRENDER_TARGET_F16C
    if constexpr (Count == 8) {
        return _mm256_cvtph_ps(load_as<__m128i>(from));
    }
#endif
    using floats = lanes<float, Count>;
    using words = lanes<std::uint32_t, Count>;
    auto const half = half_words<Count>(from);
    // Exponent and mantissa go to where a float has them, and the product moves the exponent's bias, of numbers too
    // small for a full mantissa too. Exponents of all ones are infinities and not-a-numbers.
    auto const magnitude = half & 0x7FFFU;
    auto const moved = bits_as<words>(bits_as<floats>(magnitude << 13) * 0x1p112F);
    auto const special = bits_as<words>(magnitude >= 0x7C00U) & 0x7F800000U;
    return bits_as<floats>(moved | special | (half & 0x8000U) << 16);
}

/// As many numbers as a register of `Real` holds, of whatever type they are kept in.
template <class Real, class Stored>
GENRENDER_ALWAYS_INLINE inline lanes<Real> load_widened(Stored const* from) {
    constexpr auto n = lane_count<Real>;
    if constexpr (std::same_as<Stored, Real>) {
        return load(from);
    } else if constexpr (std::same_as<Stored, float>) {
        return __builtin_convertvector((load_as<lanes<float, n>>(from)), lanes<Real>);
    } else {
        return __builtin_convertvector(widened<n>(from), lanes<Real>);
    }
}

#else

template <class Real, class Stored>
Real load_widened(Stored const* from) {
    return static_cast<Real>(*from);
}

#endif

} // namespace genrender::detail::GENRENDER_TARGET
