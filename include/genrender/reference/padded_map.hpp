// SPDX-License-Identifier: MIT
// A feature map within a ring of zeros, over which a 3x3 kernel passes without asking where the map ends.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <cstddef>

namespace genrender::reference {

/// One frame's features with one token of zeros on each side. The features themselves hold anything until they are
/// written.
template <class Real>
struct padded_map {
    stack<Real, 3> tokens; ///< [1 + height + 1, 1 + width + 1, channels]

    /// A map whose ring of zeros is written and whose tokens are not yet.
    padded_map(grid_extents grid, std::size_t channels)
        : tokens(stack<Real, 3>::uninitialized({grid.height + 2, grid.width + 2, channels})) {
        std::fill_n(tokens.data(), row_stride(), Real{0});
        for (std::size_t y = 0; y < grid.height; ++y) {
            std::fill_n(row(y) - channels, channels, Real{0});
            std::fill_n(row(y) + grid.width * channels, channels, Real{0});
        }
        std::fill_n(tokens.data() + (grid.height + 1) * row_stride(), row_stride(), Real{0});
    }

    /// The features of one frame [tokens of grid, channels] in their ring; rows of `in` contiguous. Throws shape_error
    /// if they do not fit.
    padded_map(in_view<Real, 2> in, grid_extents grid) : padded_map(grid, in.extent(1)) {
        require_shape("padded_map", "in", in, {grid.size(), channels()});
        for (std::size_t token = 0; token < in.extent(0); ++token) {
            std::copy_n(in[token].data(), channels(), row(token / grid.width) + token % grid.width * channels());
        }
    }

    /// Height and width without the ring.
    grid_extents grid() const { return {tokens.extent(0) - 2, tokens.extent(1) - 2}; }
    /// Channels of a token.
    std::size_t channels() const { return tokens.extent(2); }
    /// Numbers from one row of the map to the next.
    std::size_t row_stride() const { return tokens.extent(1) * channels(); }
    /// The tokens of row y of the map side by side.
    Real* row(std::size_t y) { return tokens.data() + (y + 1) * row_stride() + channels(); }
    /// The tokens of row y of the map side by side.
    Real const* row(std::size_t y) const { return tokens.data() + (y + 1) * row_stride() + channels(); }
    /// The first zero of the ring, above and left of the map.
    Real const* corner() const { return tokens.data(); }
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
