// SPDX-License-Identifier: MIT
// Views as xtensor expressions and back: arrays of any storage, layout and rank, and their slices, as views.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>

#if __has_include(<xtensor/containers/xadapt.hpp>)
#include <xtensor/containers/xadapt.hpp>
#include <xtensor/views/xstrided_view.hpp>
#else
#include <xtensor/xadapt.hpp>
#include <xtensor/xstrided_view.hpp>
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <type_traits>
#include <utility>

namespace genrender::adapters {

/// A view as an xtensor expression, which reads it and, unless T is const, writes it; strides are of any sign. Copies
/// nothing; the memory must outlive it.
template <class T, std::size_t Rank>
auto to_xtensor(strided_view<T, Rank> const& view) {
    std::array<std::size_t, Rank> shape = view.extents();
    std::array<std::ptrdiff_t, Rank> strides{};
    std::ptrdiff_t first = 0; // the least address, and how many elements there are from it to the greatest
    std::ptrdiff_t count = view.size() > 0 ? 1 : 0;
    for (std::size_t axis = 0; axis < Rank && view.size() > 0; ++axis) {
        // xtensor repeats the one element of an axis that others are longer along.
        strides[axis] = view.extent(axis) > 1 ? view.stride(axis) : 0;
        auto const way = static_cast<std::ptrdiff_t>(view.extent(axis) - 1) * strides[axis];
        first += std::min<std::ptrdiff_t>(way, 0);
        count += std::abs(way);
    }
    auto const elements = static_cast<std::size_t>(count);
    return xt::strided_view(
        xt::adapt(view.data() + first, elements, xt::no_ownership(), std::array<std::size_t, 1>{elements}),
        std::move(shape), std::move(strides), static_cast<std::size_t>(-first), xt::layout_type::dynamic);
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
