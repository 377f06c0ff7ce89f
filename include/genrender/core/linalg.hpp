// SPDX-License-Identifier: MIT
// The one door to Eigen: views as maps, so that matrix products run on memory that stays where it is.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/half_storage.hpp>
#include <genrender/core/strided_view.hpp>

#include <Eigen/Core>

#include <cassert>
#include <type_traits>

namespace genrender {

/// The 16-bit formats in which features may be stored, IEEE binary16 and the upper half of a float; arithmetic is done
/// in float or double.
using float16 = Eigen::half;
/// The upper half of a float.
using bfloat16 = Eigen::bfloat16;
/// Eigen's half has the format of binary16.
template <>
struct half_bits<float16> {
    using type = float16_bits; ///< binary16
};
/// Eigen's bfloat16 has the format of bfloat16.
template <>
struct half_bits<bfloat16> {
    using type = bfloat16_bits; ///< bfloat16
};

/// A row-major matrix that owns its elements.
template <class Real>
using matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A row-major matrix over foreign memory whose rows are contiguous and any distance apart.
template <class T>
using matrix_map = Eigen::Map<std::conditional_t<std::is_const_v<T>, matrix<std::remove_const_t<T>> const, matrix<T>>,
                              Eigen::Unaligned, Eigen::OuterStride<>>;

/// The Eigen map of a view [rows, columns] with contiguous rows; copies nothing.
template <class T>
matrix_map<T> to_matrix(strided_view<T, 2> const& view) {
    assert(view.rows_are_contiguous() && "to_matrix: rows of the view are not contiguous");
    return matrix_map<T>(view.data(), static_cast<Eigen::Index>(view.extent(0)),
                         static_cast<Eigen::Index>(view.extent(1)),
                         Eigen::OuterStride<>(static_cast<Eigen::Index>(view.stride(0))));
}

} // namespace genrender

namespace Eigen {

/// The library's view of an Eigen matrix of either storage order; found by argument-dependent lookup.
template <class Real, int Rows, int Columns, int Options>
genrender::strided_view<Real, 2> to_view(Matrix<Real, Rows, Columns, Options>& matrix) {
    return {matrix.data(),
            {static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols())},
            {static_cast<std::ptrdiff_t>(matrix.rowStride()), static_cast<std::ptrdiff_t>(matrix.colStride())}};
}

/// The read-only view.
template <class Real, int Rows, int Columns, int Options>
genrender::strided_view<Real const, 2> to_view(Matrix<Real, Rows, Columns, Options> const& matrix) {
    return {matrix.data(),
            {static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols())},
            {static_cast<std::ptrdiff_t>(matrix.rowStride()), static_cast<std::ptrdiff_t>(matrix.colStride())}};
}

} // namespace Eigen

#include <genrender/core/end_header.inl>
