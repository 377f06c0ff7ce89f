// SPDX-License-Identifier: MIT
// The steps between levels of the autoencoder: a convolution of stride 2 without a row above, and one over nearest
// neighbours.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/map_stripes.hpp>
#include <genrender/reference/padded_map.hpp>
#include <genrender/reference/spare_map.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <cstddef>
#include <string>

namespace genrender::reference {

/// Halves the grid (diffusers' Downsample2D with padding 0): zeros stand right of and below the map alone, so that the
/// kernel of output (y, x) begins at input (2 y, 2 x).
template <class Real>
class vae_downsampler {
public:
    /// Takes `name.conv`.
    vae_downsampler(weights<Real>& source, std::string const& name, std::size_t channels)
        : conv_(source, name + ".conv", channels, channels, 3, 2) {}

    /// The map of half the height and width, of as many channels. Throws value_error for an odd extent.
    spare_map<Real> operator()(spare_map<Real> const& x, stripe_pass const& pass) const {
        auto const grid = x.grid();
        require_value(grid.height % 2 == 0, "vae_downsampler", "height", grid.height, "an even number");
        require_value(grid.width % 2 == 0, "vae_downsampler", "width", grid.width, "an even number");
        spare_map<Real> result({grid.height / 2, grid.width / 2}, x.channels());
        auto const rows = std::max<std::size_t>(1, pass.rows<Real>(grid, x.channels()) / 2);
        auto const row_size = grid.width * x.channels();
        for (std::size_t first = 0; first < result.grid().height; first += rows) {
            auto const count = std::min(rows, result.grid().height - first);
            // A map whose ring begins with the first token, not before it.
            padded_map<Real> stripe({2 * count, grid.width}, x.channels());
            pass.loop(2 * count + 1, [&](std::size_t i) {
                auto* const to = stripe.tokens.data() + i * stripe.row_stride();
                auto const y = 2 * first + i;
                auto const size = y < grid.height ? row_size : 0;
                if (size > 0) {
                    std::copy_n(x.view()[y * grid.width].data(), size, to);
                }
                std::fill(to + size, to + stripe.row_stride(), Real{0});
            });
            conv_(result.view().slice(first * result.grid().width, count * result.grid().width), stripe,
                  {conv_.bias(), {}}, pass.loop);
        }
        return result;
    }

private:
    conv2d<Real> conv_;
};

/// Doubles the grid (diffusers' Upsample2D).
template <class Real>
class vae_upsampler {
public:
    /// Takes `name.conv`.
    vae_upsampler(weights<Real>& source, std::string const& name, std::size_t channels)
        : conv_(source, name + ".conv", channels, channels) {}

    /// The map of twice the height and width, of as many channels.
    spare_map<Real> operator()(spare_map<Real> const& x, stripe_pass const& pass) const {
        auto const width = x.grid().width;
        auto const channels = x.channels();
        grid_extents const grid{2 * x.grid().height, 2 * width};
        spare_map<Real> result(grid, channels);
        auto const write_row = [&](Real* to, std::size_t y) {
            auto const* from = x.view()[y / 2 * width].data();
            for (std::size_t column = 0; column < width; ++column, from += channels) {
                to = std::copy_n(from, channels, std::copy_n(from, channels, to));
            }
        };
        each_stripe<Real>(grid, channels, pass, write_row,
                          [&](padded_map<Real> const& stripe, std::size_t first, std::size_t count) {
                              conv_(result.view().slice(first * grid.width, count * grid.width), stripe,
                                    {conv_.bias(), {}}, pass.loop);
                          });
        return result;
    }

private:
    conv2d<Real> conv_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
