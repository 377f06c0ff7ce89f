// SPDX-License-Identifier: MIT
// Elements side by side in one register of the target, for kernels that no compiler vectorises by itself.
#pragma once

#include <cstddef>
#include <cstring>

namespace genrender::detail {

// As wide as the flags of the translation unit allow; the library sets no flags. Compilers without such vectors do one
// element at a time.
#if !defined(__GNUC__)
inline constexpr std::size_t register_bytes = 0;
#elif defined(__AVX512F__)
inline constexpr std::size_t register_bytes = 64;
#elif defined(__AVX__)
inline constexpr std::size_t register_bytes = 32;
#else
inline constexpr std::size_t register_bytes = 16;
#endif

/// How many elements of type T a register holds.
template <class T>
inline constexpr std::size_t register_lanes = register_bytes > 0 ? register_bytes / sizeof(T) : 1;

#if defined(__GNUC__)

template <class T, std::size_t Count>
struct register_vector_type {
    typedef T type __attribute__((vector_size(Count * sizeof(T))));
};

/// `Count` elements of type T that are added, multiplied and compared at once.
template <class T, std::size_t Count = register_lanes<T>>
using register_vector = typename register_vector_type<T, Count>::type;

#endif

/// A `Vector` from as many elements at any address.
template <class Vector, class T>
Vector load_as(T const* from) {
    Vector value;
    std::memcpy(&value, from, sizeof(value));
    return value;
}

/// The same bits as another type.
template <class To, class From>
To bits_as(From const& from) {
    static_assert(sizeof(To) == sizeof(From));
    To to;
    std::memcpy(&to, &from, sizeof(to));
    return to;
}

} // namespace genrender::detail
