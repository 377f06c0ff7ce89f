// SPDX-License-Identifier: MIT
// The one door to xtensor: the stacks of the built-in path (latents and maps), and their views.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>

// xtensor moved its headers into folders with release 0.26.
#if __has_include(<xtensor/containers/xtensor.hpp>)
#include <xtensor/containers/xtensor.hpp>
#else
#include <xtensor/xtensor.hpp>
#endif

#include <array>
#include <cstddef>

namespace genrender {

/// A row-major stack of `Rank` axes that owns its elements.
template <class T, std::size_t Rank>
using tensor = xt::xtensor<T, Rank, xt::layout_type::row_major>;

/// Latents of an animation, z: [frames, channels, height, width].
template <class Real>
using latents = tensor<Real, 4>;

} // namespace genrender

namespace xt {

/// The library's view of a row-major xtensor; found by argument-dependent lookup. (xtensor stores stride 0 for axes of
/// extent 1, so the view's strides come from the extents alone.)
template <class Storage, std::size_t Rank, class Tag>
auto to_view(xtensor_container<Storage, Rank, layout_type::row_major, Tag>& tensor) {
    std::array<std::size_t, Rank> extents{};
    for (std::size_t axis = 0; axis < Rank; ++axis) {
        extents[axis] = tensor.shape()[axis];
    }
    return genrender::strided_view<typename Storage::value_type, Rank>(tensor.data(), extents);
}

/// The read-only view.
template <class Storage, std::size_t Rank, class Tag>
auto to_view(xtensor_container<Storage, Rank, layout_type::row_major, Tag> const& tensor) {
    std::array<std::size_t, Rank> extents{};
    for (std::size_t axis = 0; axis < Rank; ++axis) {
        extents[axis] = tensor.shape()[axis];
    }
    return genrender::strided_view<typename Storage::value_type const, Rank>(tensor.data(), extents);
}

} // namespace xt

#include <genrender/core/end_header.inl>
