// SPDX-License-Identifier: MIT
// The steps between levels of the UNet: a convolution of stride 2 down, nearest neighbours and a convolution up.
#pragma once

#include <genrender/core/stack.hpp>
#include <genrender/models/conv2d.hpp>
#include <genrender/models/feature_maps.hpp>
#include <genrender/models/forward_pass.hpp>

#include <cstddef>
#include <string>

namespace genrender {

/// Writes every token of `in` [tokens of grid, channels] into a square of 2 x 2 tokens of `out` [4 tokens, channels].
/// Throws shape_error if they do not fit.
template <class Real>
void repeat_twice(strided_view<Real, 2> out, in_view<Real, 2> in, grid_extents grid) {
    require_shape("repeat_twice", "in", in, {grid.size(), in.extent(1)});
    require_shape("repeat_twice", "out", out, {4 * grid.size(), in.extent(1)});
    for (std::size_t token = 0; token < out.extent(0); ++token) {
        auto const row = token / (2 * grid.width);
        auto const column = token % (2 * grid.width);
        copy(out[token], in[row / 2 * grid.width + column / 2]);
    }
}

/// Halves the grid (diffusers' Downsample2D).
template <class Real>
class downsampler {
public:
    /// Takes `name.conv`.
    downsampler(weights<Real>& source, std::string const& name, std::size_t channels)
        : conv_(source, name + ".conv", channels, channels, 3, 2) {}

    template <class Pass>
    feature_maps<Real> operator()(Pass const& pass, feature_maps<Real> const& x) const {
        auto result = pass.maps(conv_.out_grid(x.grid()), x.channels());
        pass.each_frame([&](std::size_t i) { conv_(result[i], x[i], x.grid()); });
        return result;
    }

private:
    conv2d<Real> conv_;
};

/// Doubles the grid (diffusers' Upsample2D).
template <class Real>
class upsampler {
public:
    /// Takes `name.conv`.
    upsampler(weights<Real>& source, std::string const& name, std::size_t channels)
        : conv_(source, name + ".conv", channels, channels) {}

    template <class Pass>
    feature_maps<Real> operator()(Pass const& pass, feature_maps<Real> const& x) const {
        grid_extents const grid{2 * x.grid().height, 2 * x.grid().width};
        auto result = pass.maps(grid, x.channels());
        pass.each_frame([&](std::size_t i) {
            stack<Real, 2> repeated({grid.size(), x.channels()});
            repeat_twice(repeated.view(), x[i], x.grid());
            conv_(result[i], repeated, grid);
        });
        return result;
    }

private:
    conv2d<Real> conv_;
};

} // namespace genrender
