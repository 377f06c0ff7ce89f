// SPDX-License-Identifier: MIT
// One vector register of the target as a C++ type: the compiler's vectors where it has them, else a single number.
#pragma once

#include <genrender/core/register_vector.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

namespace genrender::detail {

#if defined(__GNUC__)
#define GENRENDER_ALWAYS_INLINE __attribute__((always_inline))
#else
#define GENRENDER_ALWAYS_INLINE
#endif

/// Whether the target has 32 vector registers rather than 16.
#if defined(__AVX512F__) || defined(__aarch64__)
inline constexpr bool many_vector_registers = true;
#else
inline constexpr bool many_vector_registers = false;
#endif

/// Runs body(0) ... body(N - 1) with indices that are constants, so that arrays they index stay in registers.
template <std::size_t N, class Body>
GENRENDER_ALWAYS_INLINE inline void unrolled(Body&& body) {
    [&]<std::size_t... I>(std::index_sequence<I...>) GENRENDER_ALWAYS_INLINE {
        (body(std::integral_constant<std::size_t, I>{}), ...);
    }
    (std::make_index_sequence<N>{});
}

/// Numbers side by side in one register, and unsigned integers of their size.
template <std::floating_point Real>
struct vector_lanes {
    using bits_element = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
#if defined(__GNUC__)
    using type = register_vector<Real>;
    using bits = register_vector<bits_element>;
#else
    using type = Real;
    using bits = bits_element;
#endif
};

/// The vector type and its number of lanes.
template <class Real>
using lanes = typename vector_lanes<Real>::type;
template <class Real>
inline constexpr std::size_t lane_count = register_lanes<Real>;

template <class Real>
GENRENDER_ALWAYS_INLINE inline lanes<Real> load(Real const* from) {
    return load_as<lanes<Real>>(from);
}

template <class Real>
GENRENDER_ALWAYS_INLINE inline void store(Real* to, std::type_identity_t<lanes<Real>> v) {
    std::memcpy(to, &v, sizeof v);
}

/// x in every lane.
template <class Real>
GENRENDER_ALWAYS_INLINE inline lanes<Real> spread(Real x) {
    return x - lanes<Real>{}; // less 0 and not plus 0, which would take the sign from -0
}

/// The greater of both in each lane; b where either is not a number.
template <class Real>
GENRENDER_ALWAYS_INLINE inline lanes<Real> greater(std::type_identity_t<lanes<Real>> a,
                                                   std::type_identity_t<lanes<Real>> b) {
    return a > b ? a : b;
}

/// Whether a > b in any lane.
template <class Real>
GENRENDER_ALWAYS_INLINE inline bool any_greater(std::type_identity_t<lanes<Real>> a,
                                                std::type_identity_t<lanes<Real>> b) {
    auto const is = a > b;
    if constexpr (lane_count<Real> == 1) {
        return is;
    } else {
        std::uint64_t words[sizeof is / sizeof(std::uint64_t)];
        std::memcpy(words, &is, sizeof is);
        std::uint64_t any = 0;
        unrolled<sizeof words / sizeof *words>([&](auto i) { any |= words[i]; });
        return any != 0;
    }
}

/// Bytes that come from memory together.
inline constexpr std::size_t cache_line_bytes = 64;

/// Asks for the cache line at an address to be in the second cache when it is read. Changes no value.
GENRENDER_ALWAYS_INLINE inline void prefetch_to_read([[maybe_unused]] void const* at) {
#if defined(__GNUC__)
    __builtin_prefetch(at, 0, 2);
#endif
}

/// The same for an address that will be written.
GENRENDER_ALWAYS_INLINE inline void prefetch_to_write([[maybe_unused]] void const* at) {
#if defined(__GNUC__)
    __builtin_prefetch(at, 1, 2);
#endif
}

/// Rows become columns of a square of lane_count x lane_count numbers.
template <class Real>
GENRENDER_ALWAYS_INLINE inline void transpose(lanes<Real> (&rows)[lane_count<Real>]) {
    constexpr auto n = lane_count<Real>;
    if constexpr (n > 1) {
#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define GENRENDER_HAS_SHUFFLE
#endif
#endif
#ifdef GENRENDER_HAS_SHUFFLE
        // Interleave the first half of the rows with the second, log2 n times.
        constexpr auto interleaved = []<std::size_t... I>(lanes<Real> a, lanes<Real> b, auto from,
                                                          std::index_sequence<I...>) GENRENDER_ALWAYS_INLINE {
            return __builtin_shufflevector(a, b, ((I % 2) * n + I / 2 + from())...);
        };
        constexpr std::make_index_sequence<n> all;
        constexpr std::integral_constant<std::size_t, 0> low;
        constexpr std::integral_constant<std::size_t, n / 2> high;
        unrolled<n>([&](auto round) GENRENDER_ALWAYS_INLINE {
            if constexpr ((std::size_t{1} << round()) < n) {
                lanes<Real> next[n];
                unrolled<n / 2>([&](auto i) GENRENDER_ALWAYS_INLINE {
                    next[2 * i] = interleaved(rows[i], rows[i + n / 2], low, all);
                    next[2 * i + 1] = interleaved(rows[i], rows[i + n / 2], high, all);
                });
                unrolled<n>([&](auto i) GENRENDER_ALWAYS_INLINE { rows[i] = next[i]; });
            }
        });
#undef GENRENDER_HAS_SHUFFLE
#else
        Real from[n][n];
        Real to[n][n];
        std::memcpy(from, rows, sizeof from);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j) {
                to[j][i] = from[i][j];
            }
        }
        std::memcpy(rows, to, sizeof from);
#endif
    }
}

} // namespace genrender::detail
