// SPDX-License-Identifier: MIT
// Numbers of 16 bits as kernels read them, whatever type the engine has for them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/half_precision.hpp>
#include <genrender/core/strided_view.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace genrender {

/// A number of IEEE binary16 as its bits.
struct float16_bits {
    std::uint16_t bits = 0; ///< sign, 5 bits of exponent, 10 of fraction
    /// Its value, exactly.
    template <std::floating_point Real>
    constexpr explicit operator Real() const {
        return static_cast<Real>(float_of_half(bits));
    }
};

/// A number of bfloat16 as its bits.
struct bfloat16_bits {
    std::uint16_t bits = 0; ///< sign, 8 bits of exponent, 7 of fraction
    /// Its value, exactly.
    template <std::floating_point Real>
    constexpr explicit operator Real() const {
        return static_cast<Real>(float_of_bfloat16(bits));
    }
};

/// Says how a type of 16 bits is to be read. An engine that has one specialises it with
///     using type = genrender::float16_bits; // or bfloat16_bits
/// core/linalg.hpp does so for Eigen's.
template <class T>
struct half_bits {};
/// float16_bits has the format of binary16.
template <>
struct half_bits<float16_bits> {
    using type = float16_bits; ///< binary16
};
/// bfloat16_bits has the format of bfloat16.
template <>
struct half_bits<bfloat16_bits> {
    using type = bfloat16_bits; ///< bfloat16
};

/// Types of 16 bits in which features may be stored besides the scalar that computes with them.
template <class Stored>
concept half_storage = sizeof(Stored) == 2 && requires {
    typename half_bits<std::remove_const_t<Stored>>::type;
};

/// The same memory as bits.
template <half_storage Stored, std::size_t Rank>
auto to_bits_view(strided_view<Stored, Rank> const& view) {
    using bits = typename half_bits<std::remove_const_t<Stored>>::type;
    return strided_view<bits const, Rank>(reinterpret_cast<bits const*>(view.data()), view.extents(), view.strides());
}

} // namespace genrender

#include <genrender/core/end_header.inl>
