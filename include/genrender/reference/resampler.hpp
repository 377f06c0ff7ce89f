// SPDX-License-Identifier: MIT
// The steps between levels of the UNet: a convolution of stride 2 down, nearest neighbours and a convolution up.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/feature_maps.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/padded_map.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

namespace genrender::reference {

/// Writes every token of `in` [tokens of grid, channels] into a square of 2 x 2 tokens of `out`, for a convolution.
/// Throws shape_error unless `out` is twice as high and wide.
template <class Real>
void repeat_twice(padded_map<Real>& out, in_view<Real, 2> in, grid_extents grid) {
    require_shape("repeat_twice", "in", in, {grid.size(), out.channels()});
    require_extents("repeat_twice", "grid of out", std::array{out.grid().height, out.grid().width},
                    std::array{2 * grid.height, 2 * grid.width});
    for (std::size_t y = 0; y < grid.height; ++y) {
        auto* to = out.row(2 * y);
        for (std::size_t x = 0; x < grid.width; ++x) {
            auto const* const from = in[y * grid.width + x].data();
            to = std::copy_n(from, out.channels(), std::copy_n(from, out.channels(), to));
        }
        std::copy(out.row(2 * y), to, out.row(2 * y + 1));
    }
}

/// Halves the grid (diffusers' Downsample2D).
template <class Real>
class downsampler {
public:
    /// Takes `name.conv`.
    downsampler(weights<Real>& source, std::string const& name, std::size_t channels)
        : conv_(source, name + ".conv", channels, channels, 3, 2) {}

    /// Maps of half the height and width, of as many channels.
    feature_maps<Real> operator()(forward_pass<Real> const& pass, feature_maps<Real> const& x) const {
        auto result = pass.maps(conv_.out_grid(x.grid()), x.channels());
        pass.each_frame([&](std::size_t i) { conv_(result[i], x[i], x.grid(), pass.tokens()); });
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

    /// Maps of twice the height and width, of as many channels.
    feature_maps<Real> operator()(forward_pass<Real> const& pass, feature_maps<Real> const& x) const {
        grid_extents const grid{2 * x.grid().height, 2 * x.grid().width};
        auto result = pass.maps(grid, x.channels());
        pass.each_frame([&](std::size_t i) {
            padded_map<Real> repeated(grid, x.channels());
            repeat_twice(repeated, x[i], x.grid());
            conv_(result[i], repeated, {conv_.bias()}, pass.tokens());
        });
        return result;
    }

private:
    conv2d<Real> conv_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
