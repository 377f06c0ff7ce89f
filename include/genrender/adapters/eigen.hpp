// SPDX-License-Identifier: MIT
// Views as maps of Eigen's matrices, vectors and tensors, and back: maps, blocks and tensors as views.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/linalg.hpp>
#include <genrender/core/strided_view.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace genrender::adapters {

/// A matrix over the memory of a view [rows, columns] with any strides.
template <class T>
using eigen_matrix_map =
    Eigen::Map<std::conditional_t<std::is_const_v<T>, matrix<std::remove_const_t<T>> const, matrix<T>>,
               Eigen::Unaligned, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;

/// A view [rows, columns] as Eigen's matrix; copies nothing. Throws value_error if a stride is negative, which Eigen's
/// maps do not have.
template <class T>
eigen_matrix_map<T> to_eigen(strided_view<T, 2> const& view) {
    for (auto const stride : view.strides()) {
        require_value(stride >= 0, "to_eigen", "view.stride", stride, "at least 0");
    }
    return eigen_matrix_map<T>(view.data(), static_cast<Eigen::Index>(view.extent(0)),
                               static_cast<Eigen::Index>(view.extent(1)),
                               {static_cast<Eigen::Index>(view.stride(0)), static_cast<Eigen::Index>(view.stride(1))});
}

/// A view [elements] as Eigen's column vector; copies nothing. Throws value_error if its stride is negative.
template <class T>
auto to_eigen(strided_view<T, 1> const& view) {
    using vector = Eigen::Matrix<std::remove_const_t<T>, Eigen::Dynamic, 1>;
    using constant_or_not = std::conditional_t<std::is_const_v<T>, vector const, vector>;
    require_value(view.stride(0) >= 0, "to_eigen", "view.stride", view.stride(0), "at least 0");
    return Eigen::Map<constant_or_not, Eigen::Unaligned, Eigen::InnerStride<>>(
        view.data(), static_cast<Eigen::Index>(view.extent(0)),
        Eigen::InnerStride<>(static_cast<Eigen::Index>(view.stride(0))));
}

/// A contiguous view as a `Map`, an Eigen::TensorMap of a row-major tensor of as many axes, whose header the caller has
/// included; copies nothing. Throws value_error if the view has gaps.
template <class Map, class T, std::size_t Rank>
Map to_eigen_tensor(strided_view<T, Rank> const& view) {
    static_assert(Map::NumIndices == Rank, "to_eigen_tensor: tensor and view differ in their number of axes");
    static_assert(static_cast<int>(Map::Layout) == static_cast<int>(Eigen::RowMajor),
                  "to_eigen_tensor: a tensor that is not row-major");
    require_value(view.is_contiguous(), "to_eigen_tensor", "view", "with gaps", "contiguous rows");
    typename Map::Dimensions sizes;
    for (std::size_t axis = 0; axis < Rank; ++axis) {
        sizes[axis] = static_cast<typename Map::Index>(view.extent(axis));
    }
    return Map(view.data(), sizes);
}

namespace detail {

/// A matrix, array, map or block whose elements lie in memory.
template <class Dense>
concept eigen_dense_memory = std::derived_from<Dense, Eigen::DenseBase<Dense>> &&
                             (static_cast<int>(Dense::Flags) & static_cast<int>(Eigen::DirectAccessBit)) != 0;

/// An Eigen::Tensor or Eigen::TensorMap, known by its members: their header is large, and not everybody's.
template <class Tensor>
concept eigen_tensor_memory = requires(Tensor& tensor, std::size_t axis) {
    Tensor::NumIndices;
    Tensor::Layout;
    tensor.dimensions()[axis];
    *tensor.data();
};

} // namespace detail

} // namespace genrender::adapters

namespace Eigen {

/// The library's view [rows, columns] of what lies in memory: maps, references, blocks, arrays; read-only where the
/// argument is. Found by argument-dependent lookup.
template <class Dense>
    requires genrender::adapters::detail::eigen_dense_memory<std::remove_const_t<Dense>>
auto to_view(Dense& dense) {
    using element = std::remove_pointer_t<decltype(dense.data())>;
    return genrender::strided_view<element, 2>(
        dense.data(), {static_cast<std::size_t>(dense.rows()), static_cast<std::size_t>(dense.cols())},
        {static_cast<std::ptrdiff_t>(dense.rowStride()), static_cast<std::ptrdiff_t>(dense.colStride())});
}

/// The library's view of a tensor of either storage order, axes in the tensor's order; read-only where the argument is.
template <class Tensor>
    requires genrender::adapters::detail::eigen_tensor_memory<Tensor>
auto to_view(Tensor& tensor) {
    constexpr auto rank = static_cast<std::size_t>(Tensor::NumIndices);
    constexpr auto is_row_major = static_cast<int>(Tensor::Layout) == static_cast<int>(RowMajor);
    std::array<std::size_t, rank> extents{};
    std::array<std::ptrdiff_t, rank> strides{};
    std::ptrdiff_t stride = 1;
    for (std::size_t i = 0; i < rank; ++i) {
        auto const axis = is_row_major ? rank - 1 - i : i;
        extents[axis] = static_cast<std::size_t>(tensor.dimensions()[axis]);
        strides[axis] = stride;
        stride *= static_cast<std::ptrdiff_t>(extents[axis]);
    }
    return genrender::strided_view<std::remove_pointer_t<decltype(tensor.data())>, rank>(tensor.data(), extents,
                                                                                         strides);
}

} // namespace Eigen

#include <genrender/core/end_header.inl>
