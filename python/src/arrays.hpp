// SPDX-License-Identifier: MIT
// Arrays of Python's as views, and the library's memory as NumPy arrays.
#pragma once

#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace genrender::python {

namespace nb = nanobind;

/// An array that is read, by NumPy's protocol or DLPack; what is not contiguous or of another number type is copied.
template <class T, std::size_t Rank>
using input = nb::ndarray<T const, nb::ndim<Rank>, nb::c_contig, nb::device::cpu>;
/// An array that is given out.
template <class T, std::size_t Rank>
using output = nb::ndarray<nb::numpy, T, nb::ndim<Rank>>;

/// The elements of an array of Python's.
template <class T, std::size_t Rank, class Array>
strided_view<T, Rank> view_of(Array const& array) {
    std::array<std::size_t, Rank> extents;
    for (std::size_t axis = 0; axis < Rank; ++axis) {
        extents[axis] = array.shape(axis);
    }
    return {array.data(), extents};
}

/// A NumPy array that owns `elements`, a vector or tensor.
template <std::size_t Rank, class Elements>
auto array_of(Elements elements, std::array<std::size_t, Rank> const& shape) {
    using T = std::remove_cvref_t<decltype(*elements.data())>;
    auto kept = std::make_unique<Elements>(std::move(elements));
    auto* const data = kept->data();
    nb::capsule const owner(kept.get(), [](void* object) noexcept { delete static_cast<Elements*>(object); });
    kept.release();
    return output<T, Rank>(data, Rank, shape.data(), owner);
}

/// The same of a tensor, whose shape it has.
template <class T, std::size_t Rank>
auto array_of(tensor<T, Rank> elements) {
    std::array<std::size_t, Rank> shape;
    std::copy_n(elements.shape().begin(), Rank, shape.begin());
    return array_of<Rank>(std::move(elements), shape);
}

/// A copy of an array that is to have the extents `expected`. Throws shape_error in the name of Maps and `name`.
template <class T, std::size_t Rank>
tensor<T, Rank> tensor_of(char const* name, input<T, Rank> const& array,
                          std::array<std::size_t, Rank> const& expected) {
    auto const from = view_of<T const, Rank>(array);
    require_extents("Maps", name, from.extents(), expected);
    auto result = tensor<T, Rank>::from_shape(expected);
    std::copy_n(from.data(), from.size(), result.data());
    return result;
}

} // namespace genrender::python
