// SPDX-License-Identifier: MIT
// The arithmetic of softmax attention on what fits the nearest cache: some queries, one a vector lane, over some keys.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>
#include <genrender/core/vectors.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace genrender::detail {

/// Keys of one strip, whose logits are in registers at once; also the most channels of one strip of values.
inline constexpr std::size_t strip_rows = 6;

/// Keys of a tile, whose weights stay in the nearest cache between the two products.
inline constexpr std::size_t tile_keys = 16 * strip_rows;

/// How far (as a power of 2) a logit may exceed what is subtracted from it before all is rescaled. 2^32 times any sum
/// of weights is far from overflow, so after the first keys a rescaling is rare (Milakov and Gimelshein 2018 rescale
/// at every new maximum).
inline constexpr int headroom = 32;

/// Keys and values of one head in tile_keys rows or fewer. Behind the last key, all rows repeat it and count 0 times,
/// so that the last strip is full and has a next one.
template <class Real>
struct key_tile {
    std::array<Real const*, tile_keys + strip_rows> K; ///< [keys] rows of head_size numbers
    std::array<Real const*, tile_keys> V;              ///< [keys] rows of head_size numbers
    std::array<Real, tile_keys> counts;                ///< [keys]
    std::size_t keys;
    std::size_t head_size;
    bool is_far; ///< whether each row may lie anywhere in memory; else they follow each other and are in a cache

    /// Fills up behind the last of `keys`.
    void repeat_last() {
        auto const repeat = [&](auto& rows, auto const& last) {
            std::fill(rows.begin() + static_cast<std::ptrdiff_t>(keys), rows.end(), last);
        };
        repeat(K, K[keys - 1]);
        repeat(V, V[keys - 1]);
        repeat(counts, Real{0});
    }
};

} // namespace genrender::detail

#define GENRENDER_KERNELS <genrender/attention/attention_tile.inl>
#include <genrender/core/each_target.inl>

#include <genrender/core/end_header.inl>
