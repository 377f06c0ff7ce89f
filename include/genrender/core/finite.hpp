// SPDX-License-Identifier: MIT
// Whether numbers are NaN or infinite, told by their bits: -ffast-math lets a compiler take is_finite for true.
#pragma once

#include <genrender/core/begin_header.inl>

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace genrender {

namespace detail {

/// The bits of the exponent, which are all set in infinite numbers and in NaN.
template <class Word>
inline constexpr Word exponent_bits = sizeof(Word) == 4 ? Word{0x7F800000U} : Word(0x7FF0000000000000U);

} // namespace detail

/// Whether `x` is neither infinite nor NaN. Takes a reference, since compilers that assume finite numbers may assume it
/// of arguments in registers.
template <std::floating_point Real>
    requires(sizeof(Real) == 4 || sizeof(Real) == 8)
constexpr bool is_finite(Real const& x) {
    using word = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
    return (std::bit_cast<word>(x) & detail::exponent_bits<word>) != detail::exponent_bits<word>;
}

/// Whether all coordinates are.
template <std::floating_point Real, std::size_t D>
constexpr bool is_finite(std::array<Real, D> const& point) {
    for (auto const& x : point) {
        if (!is_finite(x)) {
            return false;
        }
    }
    return true;
}

/// Whether `x` is NaN.
template <std::floating_point Real>
    requires(sizeof(Real) == 4 || sizeof(Real) == 8)
constexpr bool is_nan(Real const& x) {
    using word = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
    // Without the sign, the number after infinity is the first NaN.
    return (std::bit_cast<word>(x) & ~(word{1} << (8 * sizeof(word) - 1))) > detail::exponent_bits<word>;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
