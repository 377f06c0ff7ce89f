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
#include <memory>
#include <span>
#include <type_traits>

namespace genrender::detail {

/// Memory for `count` numbers that begins at a cache line and holds anything.
template <class Real>
class scratch_memory {
public:
    explicit scratch_memory(std::size_t count)
        : lines_(std::make_unique_for_overwrite<line[]>((count * sizeof(Real) + sizeof(line) - 1) / sizeof(line))),
          next_(reinterpret_cast<Real*>(lines_.get())) {}

    /// The next `count` of the numbers.
    Real* take(std::size_t count) {
        next_ += count;
        return next_ - count;
    }

private:
    struct alignas(64) line {
        std::byte bytes[64];
    };
    std::unique_ptr<line[]> lines_;
    Real* next_;
};

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
