// SPDX-License-Identifier: MIT
// The vectors of a target as C++ types, for kernels that no compiler vectorises by itself: one vocabulary for all.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/half_storage.hpp>
#include <genrender/core/vector_target.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#if GENRENDER_HAS_X86_TARGETS
#include <immintrin.h>
#endif

namespace genrender::detail {

/// Bytes that come from memory together.
inline constexpr std::size_t cache_line_bytes = 64;

/// The most elements of type T that a register of any target holds: what memory is padded to.
template <class T>
inline constexpr std::size_t most_lanes = 64 / sizeof(T);

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

} // namespace genrender::detail

#define GENRENDER_KERNELS <genrender/core/vectors.inl>
#include <genrender/core/each_target.inl>

#define GENRENDER_KERNELS <genrender/core/widening.inl>
#include <genrender/core/each_target.inl>

#include <genrender/core/end_header.inl>
