// SPDX-License-Identifier: MIT
// The index types: what counts frames, pixels, tokens and texels, and the extents of a grid of them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <compare>
#include <cstddef>
#include <cstdint>

namespace genrender {

/// Position of a frame in its animation, from 0.
struct frame_index {
    std::uint32_t value = 0; ///< from 0
    /// Orders by position.
    friend constexpr auto operator<=>(frame_index, frame_index) = default;
};

/// Position of a token in a feature map: row * width + column, from 0 at the top left.
struct token_index {
    std::uint32_t value = 0; ///< from 0
    /// Orders by position.
    friend constexpr auto operator<=>(token_index, token_index) = default;
};

/// Number of a surface that carries its own texture.
struct object_index {
    std::uint32_t value = 0; ///< any number; those of a scene need not be consecutive
    /// Orders by number.
    friend constexpr auto operator<=>(object_index, object_index) = default;
};

/// A pixel of a map: row 0 is the top, column 0 the left; the pixel's centre lies at (column + 0.5, row + 0.5).
struct pixel {
    std::uint32_t row = 0;    ///< from 0 at the top
    std::uint32_t column = 0; ///< from 0 at the left
    /// Orders by row, then by column.
    friend constexpr auto operator<=>(pixel, pixel) = default;
};

/// A texel of one object's texture: its centre lies at u = (column + 0.5) / T, v = (row + 0.5) / T.
struct texel {
    object_index object;      ///< whose texture
    std::uint32_t row = 0;    ///< from 0 at v = 0
    std::uint32_t column = 0; ///< from 0 at u = 0
    /// Orders by object, then by row, then by column.
    friend constexpr auto operator<=>(texel, texel) = default;
};

/// Height and width of a map, a latent or a feature map.
struct grid_extents {
    std::size_t height = 0; ///< rows
    std::size_t width = 0;  ///< columns
    /// Number of cells: height * width.
    constexpr std::size_t size() const { return height * width; }
    /// Orders by height, then by width.
    friend constexpr auto operator<=>(grid_extents, grid_extents) = default;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
