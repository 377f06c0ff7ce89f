// SPDX-License-Identifier: MIT
// A feature map within a ring of zeros, over which a 3x3 kernel passes without asking where the map ends.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/feature_memory.hpp>

#include <algorithm>
#include <cstddef>

namespace genrender::reference {

/// One frame's features [height, width, channels] with one token of zeros on each side. The features themselves hold
/// anything until they are written.
template <class Real>
class padded_map {
public:
    padded_map(grid_extents grid, std::size_t channels)
        : grid_(grid), channels_(channels), memory_((grid.height + 2) * row_stride()) {
        std::fill_n(memory_.data(), row_stride(), Real{0});
        for (std::size_t y = 0; y < grid.height; ++y) {
            std::fill_n(row(y) - channels, channels, Real{0});
            std::fill_n(row(y) + grid.width * channels, channels, Real{0});
        }
        std::fill_n(memory_.data() + (grid.height + 1) * row_stride(), row_stride(), Real{0});
    }

    /// The features of one frame [tokens of grid, channels] in their ring; rows of `in` contiguous. Throws shape_error
    /// if they do not fit.
    padded_map(in_view<Real, 2> in, grid_extents grid) : padded_map(grid, in.extent(1)) {
        require_shape("padded_map", "in", in, {grid.size(), channels_});
        for (std::size_t token = 0; token < in.extent(0); ++token) {
            std::copy_n(in[token].data(), channels_, row(token / grid.width) + token % grid.width * channels_);
        }
    }

    grid_extents grid() const { return grid_; }
    std::size_t channels() const { return channels_; }
    /// Numbers from one row of the map to the next.
    std::size_t row_stride() const { return (grid_.width + 2) * channels_; }
    /// The tokens of row y of the map side by side.
    Real* row(std::size_t y) { return memory_.data() + (y + 1) * row_stride() + channels_; }
    Real const* row(std::size_t y) const { return memory_.data() + (y + 1) * row_stride() + channels_; }
    /// The first zero of the ring, above and left of the map.
    Real const* corner() const { return memory_.data(); }

private:
    grid_extents grid_;
    std::size_t channels_;
    feature_memory<Real> memory_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
