// SPDX-License-Identifier: MIT
// A stack of feature maps between two layers, channels of a token side by side, as attention wants them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace genrender::reference {

/// Features [frames, tokens, channels] of a grid; token = row * width + column.
template <class Real>
struct feature_maps {
    stack<Real, 4> values; ///< [frames, height, width, channels]

    feature_maps() = default;

    /// Numbers that nobody has set.
    feature_maps(std::size_t frames, grid_extents grid, std::size_t channels)
        : values(stack<Real, 4>::uninitialized({frames, grid.height, grid.width, channels})) {}

    /// Number of entries of the stack.
    std::size_t frames() const { return values.extent(0); }
    /// Height and width of a map.
    grid_extents grid() const { return {values.extent(1), values.extent(2)}; }
    /// Channels of a token.
    std::size_t channels() const { return values.extent(3); }

    /// The maps as features [frames, tokens, channels].
    strided_view<Real, 3> view() { return {values.data(), {frames(), grid().size(), channels()}}; }
    /// The maps as features [frames, tokens, channels].
    strided_view<Real const, 3> view() const { return {values.data(), {frames(), grid().size(), channels()}}; }
    /// Features of entry i of the stack [tokens, channels].
    strided_view<Real, 2> operator[](std::size_t i) { return view()[i]; }
    /// Features of entry i of the stack [tokens, channels].
    strided_view<Real const, 2> operator[](std::size_t i) const { return view()[i]; }

    /// The same memory as the engine's outside writes it [frames, channels, height, width]; copies nothing.
    strided_view<Real, 4> channels_first() {
        auto const maps = values.view();
        return {values.data(),
                {frames(), channels(), grid().height, grid().width},
                {maps.stride(0), maps.stride(3), maps.stride(1), maps.stride(2)}};
    }
};

/// Adds scale * `from` to `to`, both [tokens, channels] with contiguous rows. Throws shape_error if they differ.
template <class Real>
void add_scaled(strided_view<Real, 2> to, in_view<Real, 2> from, std::type_identity_t<Real> scale = 1) {
    require_shape("add_scaled", "from", from, to.extents());
    for (std::size_t token = 0; token < to.extent(0); ++token) {
        auto const out = to[token].row();
        auto const in = from[token].row();
        for (std::size_t c = 0; c < out.size(); ++c) {
            out[c] += scale * in[c];
        }
    }
}

/// Multiplies `maps` [tokens, channels], whose rows are contiguous, by `factor`.
template <class Real>
void scale_by(strided_view<Real, 2> maps, std::type_identity_t<Real> factor) {
    for (std::size_t token = 0; token < maps.extent(0); ++token) {
        for (auto& value : maps[token].row()) {
            value *= factor;
        }
    }
}

/// Writes the channels of `first` and then those of `second` into `out`, a token at a time: skip connections. Throws
/// shape_error unless tokens agree and channels add up.
template <class Real>
void concatenate(strided_view<Real, 2> out, in_view<Real, 2> first, in_view<Real, 2> second) {
    require_shape("concatenate", "second", second, {first.extent(0), second.extent(1)});
    require_shape("concatenate", "out", out, {first.extent(0), first.extent(1) + second.extent(1)});
    for (std::size_t token = 0; token < out.extent(0); ++token) {
        auto const to = out[token].row();
        auto const a = first[token].row();
        auto const b = second[token].row();
        std::copy(b.begin(), b.end(), std::copy(a.begin(), a.end(), to.begin()));
    }
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
