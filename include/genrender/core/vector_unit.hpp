// SPDX-License-Identifier: MIT
// The flags of a translation unit as a name, and the vector targets that its kernels are compiled for besides.
#pragma once

#include <genrender/core/begin_header.inl>

// Objects of one program may be compiled with different flags. Code that follows the flags must then not have the same
// name in both, or the linker keeps one for all. So what a kernel is made of lies in a namespace named after the flags,
// GENRENDER_UNIT, and so do the functions that choose between its targets. It is an inline namespace: nobody spells it.

#define GENRENDER_PASTE_EXPANDED(a, b, c, d, e, f, g, h, i) a##b##c##d##e##f##g##h##i
#define GENRENDER_PASTE(a, b, c, d, e, f, g, h, i) GENRENDER_PASTE_EXPANDED(a, b, c, d, e, f, g, h, i)

#if defined(__SSE4_2__)
#define GENRENDER_UNIT_SSE _sse42
#elif defined(__SSE4_1__)
#define GENRENDER_UNIT_SSE _sse41
#elif defined(__SSSE3__)
#define GENRENDER_UNIT_SSE _ssse3
#elif defined(__SSE3__)
#define GENRENDER_UNIT_SSE _sse3
#else
#define GENRENDER_UNIT_SSE
#endif

#if defined(__AVX2__)
#define GENRENDER_UNIT_AVX _avx2
#elif defined(__AVX__)
#define GENRENDER_UNIT_AVX _avx
#else
#define GENRENDER_UNIT_AVX
#endif

#if defined(__FMA__)
#define GENRENDER_UNIT_FMA _fma
#else
#define GENRENDER_UNIT_FMA
#endif

#if defined(__F16C__)
#define GENRENDER_UNIT_F16C _f16c
#else
#define GENRENDER_UNIT_F16C
#endif

// What compilers use in whole numbers and loops by themselves.
#if defined(__BMI2__) && defined(__LZCNT__) && defined(__MOVBE__)
#define GENRENDER_UNIT_BITS _bmi2_lzcnt_movbe
#elif defined(__BMI2__)
#define GENRENDER_UNIT_BITS _bmi2
#elif defined(__BMI__)
#define GENRENDER_UNIT_BITS _bmi
#elif defined(__POPCNT__)
#define GENRENDER_UNIT_BITS _popcnt
#else
#define GENRENDER_UNIT_BITS
#endif

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && defined(__AVX512DQ__) &&                 \
    defined(__AVX512VL__)
#define GENRENDER_UNIT_AVX512 _avx512
#elif defined(__AVX512F__)
#define GENRENDER_UNIT_AVX512 _avx512f
#else
#define GENRENDER_UNIT_AVX512
#endif

// Later additions to AVX-512 and AVX2, each with those before it in the processors that have it.
#if defined(__AVX512FP16__)
#define GENRENDER_UNIT_LATER _fp16
#elif defined(__AVX512BF16__)
#define GENRENDER_UNIT_LATER _bf16
#elif defined(__AVX512VBMI2__)
#define GENRENDER_UNIT_LATER _vbmi2
#elif defined(__AVX512VNNI__)
#define GENRENDER_UNIT_LATER _vnni
#elif defined(__AVXVNNI__)
#define GENRENDER_UNIT_LATER _avxvnni
#elif defined(__XOP__) || defined(__FMA4__)
#define GENRENDER_UNIT_LATER _xop
#else
#define GENRENDER_UNIT_LATER
#endif

// Arithmetic by other rules.
#if defined(__FAST_MATH__)
#define GENRENDER_UNIT_MATH _fast_math
#else
#define GENRENDER_UNIT_MATH
#endif

#if defined(GENRENDER_OWN_FLAGS_ONLY)
#define GENRENDER_UNIT_ALONE unit_alone
#else
#define GENRENDER_UNIT_ALONE unit
#endif

/// The inline namespace of what follows the flags, such as `unit_avx2_fma`.
#define GENRENDER_UNIT                                                                                                 \
    GENRENDER_PASTE(GENRENDER_UNIT_ALONE, GENRENDER_UNIT_SSE, GENRENDER_UNIT_AVX, GENRENDER_UNIT_FMA,                  \
                    GENRENDER_UNIT_F16C, GENRENDER_UNIT_BITS, GENRENDER_UNIT_AVX512, GENRENDER_UNIT_LATER,             \
                    GENRENDER_UNIT_MATH)

/// The vector_target of the flags: 0 baseline, 1 v3, 2 v4.
#if defined(__AVX2__) && defined(__FMA__) && defined(__F16C__) && defined(__AVX512F__) && defined(__AVX512BW__) &&     \
    defined(__AVX512CD__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#define GENRENDER_OWN_TARGET 2
#elif defined(__AVX2__) && defined(__FMA__) && defined(__F16C__)
#define GENRENDER_OWN_TARGET 1
#else
#define GENRENDER_OWN_TARGET 0
#endif

/// Whether the compiler can compile functions for targets above its flags; GENRENDER_OWN_FLAGS_ONLY forbids it.
#if defined(__GNUC__) && defined(__x86_64__)
#define GENRENDER_HAS_X86_TARGETS 1
#else
#define GENRENDER_HAS_X86_TARGETS 0
#endif
#if GENRENDER_HAS_X86_TARGETS && !defined(GENRENDER_OWN_FLAGS_ONLY) && GENRENDER_OWN_TARGET < 2
#define GENRENDER_COMPILES_V4 1
#else
#define GENRENDER_COMPILES_V4 0
#endif
#if GENRENDER_COMPILES_V4 && GENRENDER_OWN_TARGET < 1
#define GENRENDER_COMPILES_V3 1
#else
#define GENRENDER_COMPILES_V3 0
#endif

#include <genrender/core/end_header.inl>
