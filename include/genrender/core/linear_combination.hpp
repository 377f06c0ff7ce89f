// SPDX-License-Identifier: MIT
// Sums of factors times numbers, element by element and once over memory: what samplers and guidance are made of.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/vectors.hpp>

#include <array>
#include <cassert>
#include <cstddef>

#define GENRENDER_KERNELS <genrender/core/linear_combination.inl>
#include <genrender/core/each_target.inl>

namespace genrender {

namespace detail {

inline namespace GENRENDER_UNIT {

/// linear_combination of neighbouring elements.
template <class Real, std::size_t Terms>
void combine_values(Real* out, std::size_t count, std::array<Real, Terms> const& factors,
                    std::array<Real const*, Terms> const& in) {
    GENRENDER_KERNEL(detail, combine<Real, Terms>)(out, count, factors, in);
}

GENRENDER_INSTANCE(combine_values<float, 2>);
GENRENDER_INSTANCE(combine_values<float, 3>);
GENRENDER_INSTANCE(combine_values<double, 2>);
GENRENDER_INSTANCE(combine_values<double, 3>);

} // namespace GENRENDER_UNIT

} // namespace detail

inline namespace GENRENDER_UNIT {

/// out[e] = factors[0] * in[0][e] + factors[1] * in[1][e] + ... for `count` neighbouring elements each. `out` may be
/// one of `in`.
template <class Real, std::size_t Terms>
void linear_combination(Real* out, std::size_t count, std::array<Real, Terms> const& factors,
                        std::array<Real const*, Terms> const& in) {
    detail::combine_values(out, count, factors, in);
}

/// The same for views of equal extents and any strides.
template <class Real, std::size_t Rank, std::size_t Terms>
void linear_combination(strided_view<Real, Rank> out, std::array<Real, Terms> const& factors,
                        std::array<strided_view<Real const, Rank>, Terms> const& in) {
    auto is_contiguous = out.is_contiguous();
    for (auto const& term : in) {
        assert(term.extents() == out.extents() && "linear_combination: views of other extents");
        is_contiguous = is_contiguous && term.is_contiguous();
    }
    if (is_contiguous) {
        std::array<Real const*, Terms> data;
        for (std::size_t n = 0; n < Terms; ++n) {
            data[n] = in[n].data();
        }
        linear_combination(out.data(), out.size(), factors, data);
    } else if constexpr (Rank == 1) {
        for (std::size_t e = 0; e < out.extent(0); ++e) {
            auto sum = factors[0] * in[0](e);
            for (std::size_t n = 1; n < Terms; ++n) {
                sum += factors[n] * in[n](e);
            }
            out(e) = sum;
        }
    } else {
        for (std::size_t i = 0; i < out.extent(0); ++i) {
            std::array<strided_view<Real const, Rank - 1>, Terms> rows;
            for (std::size_t n = 0; n < Terms; ++n) {
                rows[n] = in[n][i];
            }
            linear_combination(out[i], factors, rows);
        }
    }
}

} // namespace GENRENDER_UNIT

} // namespace genrender

#include <genrender/core/end_header.inl>
