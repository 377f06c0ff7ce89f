// SPDX-License-Identifier: MIT
// Includes the file that GENRENDER_KERNELS names, as <genrender/room/name.inl>, once for each vector target.
//
// Such a file has no include guard and no includes. What it holds lies in
//     namespace genrender::detail::GENRENDER_TARGET { ... }
// and is written with the vectors of core/vectors.inl, which are those of the target. Both compilers give a region's
// instructions to all functions, templates and lambdas in it. They do not define the macros that go with them, so code
// asks GENRENDER_TARGET_AVX512 and not __AVX512F__. No vector is an argument or a result of a function that is not
// inlined. Functions of the standard library that a kernel calls have the unit's flags; they belong outside of loops.

#if defined(__GNUC__)
#define GENRENDER_ALWAYS_INLINE __attribute__((always_inline))
#else
#define GENRENDER_ALWAYS_INLINE
#endif

// The flags' own.
#define GENRENDER_TARGET inline GENRENDER_UNIT::baseline
#define GENRENDER_TARGET_NAME baseline
#if !defined(__GNUC__)
#define GENRENDER_TARGET_BYTES 0
#elif defined(__AVX512F__)
#define GENRENDER_TARGET_BYTES 64
#elif defined(__AVX__)
#define GENRENDER_TARGET_BYTES 32
#else
#define GENRENDER_TARGET_BYTES 16
#endif
#if defined(__GNUC__) && defined(__AVX512F__)
#define GENRENDER_TARGET_AVX512 1
#else
#define GENRENDER_TARGET_AVX512 0
#endif
#if defined(__GNUC__) && defined(__AVX2__)
#define GENRENDER_TARGET_AVX2 1
#else
#define GENRENDER_TARGET_AVX2 0
#endif
#if defined(__GNUC__) && defined(__F16C__)
#define GENRENDER_TARGET_F16C 1
#else
#define GENRENDER_TARGET_F16C 0
#endif
#include GENRENDER_KERNELS
#undef GENRENDER_TARGET
#undef GENRENDER_TARGET_NAME
#undef GENRENDER_TARGET_BYTES
#undef GENRENDER_TARGET_AVX512
#undef GENRENDER_TARGET_AVX2
#undef GENRENDER_TARGET_F16C

#if GENRENDER_COMPILES_V3
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma,f16c,bmi,bmi2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma,f16c,bmi,bmi2")
#endif
#define GENRENDER_TARGET inline GENRENDER_UNIT::v3
#define GENRENDER_TARGET_NAME v3
#define GENRENDER_TARGET_BYTES 32
#define GENRENDER_TARGET_AVX512 0
#define GENRENDER_TARGET_AVX2 1
#define GENRENDER_TARGET_F16C 1
#include GENRENDER_KERNELS
#undef GENRENDER_TARGET
#undef GENRENDER_TARGET_NAME
#undef GENRENDER_TARGET_BYTES
#undef GENRENDER_TARGET_AVX512
#undef GENRENDER_TARGET_AVX2
#undef GENRENDER_TARGET_F16C
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif

#if GENRENDER_COMPILES_V4
#if defined(__clang__)
#pragma clang attribute push(                                                                                          \
    __attribute__((target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx2,fma,f16c,bmi,bmi2"))),                     \
    apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx2,fma,f16c,bmi,bmi2,prefer-vector-width=512")
#endif
#define GENRENDER_TARGET inline GENRENDER_UNIT::v4
#define GENRENDER_TARGET_NAME v4
#define GENRENDER_TARGET_BYTES 64
#define GENRENDER_TARGET_AVX512 1
#define GENRENDER_TARGET_AVX2 1
#define GENRENDER_TARGET_F16C 1
#include GENRENDER_KERNELS
#undef GENRENDER_TARGET
#undef GENRENDER_TARGET_NAME
#undef GENRENDER_TARGET_BYTES
#undef GENRENDER_TARGET_AVX512
#undef GENRENDER_TARGET_AVX2
#undef GENRENDER_TARGET_F16C
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif

#undef GENRENDER_ALWAYS_INLINE
#undef GENRENDER_KERNELS
