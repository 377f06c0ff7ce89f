// SPDX-License-Identifier: MIT
// Views as xtensor expressions and back: arrays of any storage, layout and rank, and their slices, as views.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace genrender::adapters {

/// An xtensor expression over the memory of a view with any strides that are not negative.
template <class T, std::size_t Rank>
using xtensor_map = xt::xtensor_adaptor<xt::xbuffer_adaptor<T*, xt::no_ownership, std::allocator<std::remove_const_t<T>>>,
                                        Rank, xt::layout_type::dynamic>;

/// A view as an xtensor expression, which reads it and, unless T is const, writes it; copies nothing. Throws value_error
/// if a stride along several elements is negative: xtensor counts from the least address.
template <class T, std::size_t Rank>
xtensor_map<T, Rank> to_xtensor(strided_view<T, Rank> const& view) {
    typename xtensor_map<T, Rank>::shape_type shape{};
    typename xtensor_map<T, Rank>::strides_type strides{};
    for (std::size_t axis = 0; axis < Rank; ++axis) {
        shape[axis] = view.extent(axis);
        // xtensor repeats the one element of an axis that others are longer along.
        strides[axis] = view.extent(axis) > 1 ? view.stride(axis) : 0;
        require_value(strides[axis] >= 0, "to_xtensor", "view.stride", strides[axis], "at least 0");
    }
    typename xtensor_map<T, Rank>::storage_type memory(view.data(), view.size());
    return xtensor_map<T, Rank>(std::move(memory), shape, strides);
}

/// The view of `Rank` axes of an xtensor expression that lies in memory: an array, an adaptor or a slice of these. Copies
/// nothing; read-only where the argument is. Throws value_error if the expression has another number of axes.
template <std::size_t Rank, class Expression>
auto view_of(Expression& expression) {
    require_value(expression.dimension() == Rank, "view_of", "expression.dimension()", expression.dimension(),
                  "the number of axes of the view");
    std::array<std::size_t, Rank> extents{};
    std::array<std::ptrdiff_t, Rank> strides{};
    for (std::size_t axis = 0; axis < Rank; ++axis) {
        extents[axis] = static_cast<std::size_t>(expression.shape()[axis]);
        strides[axis] = static_cast<std::ptrdiff_t>(expression.strides()[axis]);
    }
    auto* const first = expression.data() + expression.data_offset();
    return strided_view<std::remove_pointer_t<decltype(expression.data())>, Rank>(first, extents, strides);
}

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
