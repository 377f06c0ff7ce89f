// SPDX-License-Identifier: MIT
// Between the caller's views and the tiles of attention: queries in, keys and values of all blocks in a row, results
// out.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_tile.hpp>
#include <genrender/attention/key_value_view.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>

namespace genrender::detail {

/// Columns of one head of a view [tokens, channels].
template <class T>
strided_view<T, 2> head_of(strided_view<T, 2> view, std::size_t head, std::size_t head_size) {
    return {view.data() + static_cast<std::ptrdiff_t>(head * head_size) * view.stride(1),
            {view.extent(0), head_size},
            view.strides()};
}

} // namespace genrender::detail

#define GENRENDER_KERNELS <genrender/attention/attention_scratch.inl>
#include <genrender/core/each_target.inl>

#include <genrender/core/end_header.inl>
