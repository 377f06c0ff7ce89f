// SPDX-License-Identifier: MIT
// A contiguous block of elements that the library owns where it must: projected keys, recorded features, scratch.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace genrender {

/// Owns `extents` elements, row-major, value-initialised.
template <class T, std::size_t Rank>
class stack {
public:
    using value_type = T;

    stack() = default;

    /// Allocates zeros.
    explicit stack(std::array<std::size_t, Rank> const& extents) : extents_(extents) {
        std::size_t count = 1;
        for (auto const extent : extents) {
            count *= extent;
        }
        values_.resize(count);
    }

    std::array<std::size_t, Rank> const& extents() const { return extents_; }
    std::size_t extent(std::size_t axis) const { return extents_[axis]; }
    std::size_t size() const { return values_.size(); }
    T* data() { return values_.data(); }
    T const* data() const { return values_.data(); }

    strided_view<T, Rank> view() { return {values_.data(), extents_}; }
    strided_view<T const, Rank> view() const { return {values_.data(), extents_}; }

    template <class... Index>
    T& operator()(Index... index) {
        return view()(index...);
    }
    template <class... Index>
    T const& operator()(Index... index) const {
        return view()(index...);
    }

    friend strided_view<T, Rank> to_view(stack& owner) { return owner.view(); }
    friend strided_view<T const, Rank> to_view(stack const& owner) { return owner.view(); }

private:
    std::array<std::size_t, Rank> extents_{};
    std::vector<T> values_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
