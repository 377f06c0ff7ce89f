// SPDX-License-Identifier: MIT
// The view at every public door: a pointer, extents and signed strides over memory that stays its owner's.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <array>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>

// The customisation point of the library's views, all of it: an engine makes its tensor type acceptable by a function
//     genrender::strided_view<T, Rank> to_view(its_tensor&);
// in the tensor's own namespace. core/tensor.hpp (xtensor), core/linalg.hpp (Eigen) and core/stack.hpp hold the
// library's.

namespace genrender {

template <class T, std::size_t Rank>
class strided_view;

namespace detail {

template <class View>
struct view_of_tensor;

template <class T, std::size_t Rank>
struct view_of_tensor<strided_view<T, Rank>> {
    template <class Tensor>
    static constexpr bool holds = requires(Tensor&& tensor) {
        { to_view(tensor) } -> std::convertible_to<strided_view<T, Rank>>;
    };
};

} // namespace detail

/// A view of `Rank` axes over elements of type `T` (const-qualified for input). Strides count elements, may be
/// negative, and are 0 along a repeated axis. Copying a view copies no element; the memory must outlive it.
template <class T, std::size_t Rank>
class strided_view {
    static_assert(Rank >= 1, "strided_view: a view has at least one axis");

public:
    using element_type = T;                             ///< type of an element, const if it may not be written
    using value_type = std::remove_cv_t<T>;             ///< the same without const
    using extents_type = std::array<std::size_t, Rank>; ///< elements along each axis
    /// Elements of memory from one index to the next, along each axis; any sign.
    using strides_type = std::array<std::ptrdiff_t, Rank>;

    constexpr strided_view() = default;

    /// Views `extents` elements at `data`, `strides` elements apart.
    constexpr strided_view(T* data, extents_type extents, strides_type strides)
        : data_(data), extents_(extents), strides_(strides) {}

    /// Views a contiguous row-major block.
    constexpr strided_view(T* data, extents_type extents) : data_(data), extents_(extents) {
        auto const* const extent = extents_.data();
        auto* const strides = strides_.data();
        std::ptrdiff_t stride = 1;
        for (std::size_t axis = Rank; axis-- > 0;) {
            strides[axis] = stride;
            stride *= static_cast<std::ptrdiff_t>(extent[axis]);
        }
    }

    /// Views mutable elements as constant ones.
    template <class Mutable>
        requires(!std::is_const_v<Mutable> && std::same_as<Mutable const, T>)
    constexpr strided_view(strided_view<Mutable, Rank> const& other)
        : data_(other.data()), extents_(other.extents()), strides_(other.strides()) {}

    /// Views an engine's tensor through its `to_view`.
    template <class Tensor>
        requires(!std::is_base_of_v<strided_view<value_type, Rank>, std::remove_cvref_t<Tensor>> &&
                 !std::is_base_of_v<strided_view<value_type const, Rank>, std::remove_cvref_t<Tensor>> &&
                 detail::view_of_tensor<strided_view>::template holds<Tensor>)
    constexpr strided_view(Tensor&& tensor) : strided_view(static_cast<strided_view>(to_view(tensor))) {}

    /// The element at index 0 of each axis.
    constexpr T* data() const { return data_; }
    /// Extent of every axis.
    constexpr extents_type const& extents() const { return extents_; }
    /// Elements of memory from one index to the next, of every axis.
    constexpr strides_type const& strides() const { return strides_; }
    /// Extent of one axis, counted from 0.
    constexpr std::size_t extent(std::size_t axis) const {
        assert(axis < Rank && "strided_view: no such axis");
        return extents_.data()[axis];
    }
    /// Elements of memory from one index to the next of one axis.
    constexpr std::ptrdiff_t stride(std::size_t axis) const { return strides_[axis]; }

    /// Number of elements.
    constexpr std::size_t size() const {
        std::size_t count = 1;
        for (auto const extent : extents_) {
            count *= extent;
        }
        return count;
    }

    /// The element at one index per axis; indices are not checked but by assert.
    template <class... Index>
        requires(sizeof...(Index) == Rank)
    constexpr T& operator()(Index... index) const {
        // Pointers, because std::array's operator[] is a call where nothing is optimised: a third of a debug build's time.
        [[maybe_unused]] auto const* extent = extents_.data();
        auto const* stride = strides_.data();
        std::ptrdiff_t offset = 0;
        ((assert(static_cast<std::size_t>(index) < *extent && "strided_view: index beyond its axis"),
          offset += static_cast<std::ptrdiff_t>(index) * *stride, ++extent, ++stride),
         ...);
        return data_[offset];
    }

    /// The view of one index of the first axis.
    constexpr strided_view<T, Rank - 1> operator[](std::size_t index) const requires(Rank > 1) {
        assert(index < extents_[0] && "strided_view: index beyond the first axis");
        std::array<std::size_t, Rank - 1> extents{};
        std::array<std::ptrdiff_t, Rank - 1> strides{};
        auto const* const extent = extents_.data();
        auto const* const stride = strides_.data();
        auto* const extents_left = extents.data();
        auto* const strides_left = strides.data();
        for (std::size_t axis = 1; axis < Rank; ++axis) {
            extents_left[axis - 1] = extent[axis];
            strides_left[axis - 1] = stride[axis];
        }
        return {data_ + static_cast<std::ptrdiff_t>(index) * *stride, extents, strides};
    }

    /// The view of `count` indices of the first axis from `begin` on.
    constexpr strided_view slice(std::size_t begin, std::size_t count) const {
        assert(begin + count <= extents_[0] && "strided_view: slice beyond the first axis");
        auto extents = extents_;
        extents[0] = count;
        return {data_ + static_cast<std::ptrdiff_t>(begin) * strides_[0], extents, strides_};
    }

    /// Whether the elements of the last axis are neighbours in memory.
    constexpr bool rows_are_contiguous() const { return strides_[Rank - 1] == 1 || extents_[Rank - 1] <= 1; }

    /// Whether all elements lie in one row-major block.
    constexpr bool is_contiguous() const {
        std::ptrdiff_t stride = 1;
        for (std::size_t axis = Rank; axis-- > 0;) {
            if (extents_[axis] > 1 && strides_[axis] != stride) {
                return false;
            }
            stride *= static_cast<std::ptrdiff_t>(extents_[axis]);
        }
        return true;
    }

    /// The elements of a one-axis contiguous view, as a span.
    constexpr std::span<T> row() const requires(Rank == 1) {
        assert(rows_are_contiguous() && "strided_view: row() of elements that are not neighbours");
        return {data_, extents_[0]};
    }

private:
    T* data_ = nullptr;
    extents_type extents_{};
    strides_type strides_{};
};

/// A read-only view as a function parameter that leaves the deduction of `Real` and `Rank` to the out-parameter, so
/// that tensors, mutable views and constant views all convert to it.
template <class Real, std::size_t Rank>
using in_view = std::type_identity_t<strided_view<Real const, Rank>>;

/// Throws shape_error unless the view has the expected extents.
template <class T, std::size_t Rank>
void require_shape(char const* function, char const* argument, strided_view<T, Rank> const& view,
                   std::array<std::size_t, Rank> const& expected) {
    if (view.extents() != expected) {
        require_extents(function, argument, view.extents(), expected);
    }
}

/// Copies element by element between views of equal extents, whatever their strides. Throws shape_error if they differ.
template <class T, std::size_t Rank>
void copy(strided_view<T, Rank> to, in_view<T, Rank> from) {
    require_shape("copy", "from", from, to.extents());
    if constexpr (Rank == 1) {
        for (std::size_t i = 0; i < to.extent(0); ++i) {
            to(i) = from(i);
        }
    } else {
        for (std::size_t i = 0; i < to.extent(0); ++i) {
            copy(to[i], from[i]);
        }
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
