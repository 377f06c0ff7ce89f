// SPDX-License-Identifier: MIT
// A contiguous block of elements that the library owns where it must: projected keys, recorded features, scratch.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace genrender {

/// Owns `extents` elements, row-major; the first begins at a cache line. Copies copy all elements, moves take the block
/// along and leave a stack of none. Elements are numbers or plain records, for which bytes of zero mean zero. Throws
/// std::bad_alloc where there is no memory for them.
template <class T, std::size_t Rank>
class stack {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>,
                  "stack: elements are copied as bytes, so they must be trivially copyable");

public:
    using value_type = T; ///< type of an element

    /// Bytes of a cache line, at which a block begins.
    static constexpr std::size_t line_bytes = 64;
    static_assert(alignof(T) <= line_bytes, "stack: elements that must lie at more than a cache line's bytes");

    stack() = default;

    /// Allocates zeros.
    explicit stack(std::array<std::size_t, Rank> const& extents) : stack(extents, not_set{}) {
        if (size() > 0) {
            std::memset(static_cast<void*>(data()), 0, size() * sizeof(T));
        }
    }

    /// Allocates elements that hold anything until they are written.
    static stack uninitialized(std::array<std::size_t, Rank> const& extents) { return stack(extents, not_set{}); }

    /// A copy with elements of its own.
    stack(stack const& other) : stack(other.extents_, not_set{}) {
        if (size() > 0) {
            std::memcpy(static_cast<void*>(data()), other.data(), size() * sizeof(T));
        }
    }
    /// Takes the block along and leaves `other` without elements.
    stack(stack&& other) noexcept
        : extents_(std::exchange(other.extents_, {})), elements_(std::move(other.elements_)) {}
    /// Takes the block of its argument along, which is a copy unless it was moved.
    stack& operator=(stack other) noexcept {
        extents_ = other.extents_;
        elements_ = std::move(other.elements_);
        return *this;
    }
    ~stack() = default;

    /// Extent of every axis.
    std::array<std::size_t, Rank> const& extents() const { return extents_; }
    /// Extent of one axis, counted from 0.
    std::size_t extent(std::size_t axis) const { return extents_[axis]; }
    /// Number of elements.
    std::size_t size() const { return view().size(); }
    /// Elements in row-major order; the first lies at the beginning of a cache line.
    T* data() { return elements_.get(); }
    /// Elements in row-major order.
    T const* data() const { return elements_.get(); }

    /// View of all elements.
    strided_view<T, Rank> view() { return {data(), extents_}; }
    /// View of all elements.
    strided_view<T const, Rank> view() const { return {data(), extents_}; }

    /// Element at one index an axis, each below the axis' extent.
    template <class... Index>
    T& operator()(Index... index) {
        return data()[offset_of(index...)];
    }
    /// Element at one index an axis, each below the axis' extent.
    template <class... Index>
    T const& operator()(Index... index) const {
        return data()[offset_of(index...)];
    }

    /// View of all elements, found where views are asked for.
    friend strided_view<T, Rank> to_view(stack& owner) { return owner.view(); }
    /// View of all elements, found where views are asked for.
    friend strided_view<T const, Rank> to_view(stack const& owner) { return owner.view(); }

private:
    struct not_set {};
    struct release {
        void operator()(T* elements) const { ::operator delete (elements, std::align_val_t{line_bytes}); }
    };

    /// Elements before that at one index an axis.
    template <class... Index>
    std::size_t offset_of(Index... index) const {
        static_assert(sizeof...(Index) == Rank, "stack: an element is named by one index an axis");
        auto const* extent = extents_.data();
        std::size_t offset = 0;
        ((assert(static_cast<std::size_t>(index) < *extent && "stack: index beyond its axis"),
          offset = offset * *extent + static_cast<std::size_t>(index), ++extent),
         ...);
        return offset;
    }

    stack(std::array<std::size_t, Rank> const& extents, not_set) : extents_(extents) {
        if (std::find(extents.begin(), extents.end(), std::size_t{0}) != extents.end()) {
            return;
        }
        auto bytes = sizeof(T);
        for (auto const extent : extents) {
            if (extent > std::numeric_limits<std::size_t>::max() / bytes) {
                throw std::bad_array_new_length();
            }
            bytes *= extent;
        }
        elements_.reset(static_cast<T*>(::operator new (bytes, std::align_val_t{line_bytes})));
    }

    std::array<std::size_t, Rank> extents_{};
    std::unique_ptr<T, release> elements_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
