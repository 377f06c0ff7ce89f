// SPDX-License-Identifier: MIT
// Elements side by side in one register of the target, for kernels that no compiler vectorises by itself.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

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

#if defined(__GNUC__)

/// The elements of a register folded into one by `fold(a, b)`, half onto half.
template <class Vector, class Fold>
auto folded(Vector const& values, Fold const& fold) {
    using T = std::remove_cvref_t<decltype(values[0])>;
    constexpr auto count = sizeof(Vector) / sizeof(T);
    if constexpr (count == 2) {
        return fold(values[0], values[1]);
    } else {
        std::array<register_vector<T, count / 2>, 2> halves;
        std::memcpy(halves.data(), &values, sizeof(values));
        return folded(fold(halves[0], halves[1]), fold);
    }
}

/// 0, 1, 2, ...
inline register_vector<std::int32_t> lane_numbers() {
    register_vector<std::int32_t> lane{};
    for (std::size_t n = 0; n < register_lanes<std::int32_t>; ++n) {
        lane[n] = static_cast<std::int32_t>(n);
    }
    return lane;
}

#endif

} // namespace genrender::detail
