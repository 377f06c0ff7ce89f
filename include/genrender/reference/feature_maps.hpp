// SPDX-License-Identifier: MIT
// A stack of feature maps between two layers, channels of a token side by side, as attention wants them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/feature_memory.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

namespace genrender::reference {

/// Features [frames, tokens, channels] of a grid; token = row * width + column.
template <class Real>
class feature_maps {
public:
    feature_maps() = default;

    /// Numbers that nobody has set.
    feature_maps(std::size_t frames, grid_extents grid, std::size_t channels)
        : grid_(grid), extents_{frames, grid.size(), channels}, values_(frames * grid.size() * channels) {}

    grid_extents grid() const { return grid_; }
    std::size_t frames() const { return extents_[0]; }
    std::size_t channels() const { return extents_[2]; }

    strided_view<Real, 3> view() { return {values_.data(), extents_}; }
    strided_view<Real const, 3> view() const { return {values_.data(), extents_}; }
    /// Features of entry i of the stack [tokens, channels].
    strided_view<Real, 2> operator[](std::size_t i) { return view()[i]; }
    strided_view<Real const, 2> operator[](std::size_t i) const { return view()[i]; }

    /// The same memory as the engine's outside writes it [frames, channels, height, width]; copies nothing.
    strided_view<Real, 4> channels_first() {
        auto const row = static_cast<std::ptrdiff_t>(grid_.width * channels());
        return {
            values_.data(),
            {frames(), channels(), grid_.height, grid_.width},
            {static_cast<std::ptrdiff_t>(grid_.size() * channels()), 1, row, static_cast<std::ptrdiff_t>(channels())}};
    }

private:
    grid_extents grid_;
    std::array<std::size_t, 3> extents_{};
    feature_memory<Real> values_;
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
