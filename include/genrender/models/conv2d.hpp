// SPDX-License-Identifier: MIT
// Convolution with 3x3 or 1x1 kernels as matrix products of gathered neighbourhoods.
#pragma once

#include <genrender/core/index.hpp>
#include <genrender/core/linalg.hpp>
#include <genrender/models/weights.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace genrender {

/// A convolution, strictly a cross-correlation, of feature maps [tokens, channels] with zeros around them: kernel k (1
/// or 3), padding k / 2, stride 1 or more.
template <class Real>
class conv2d {
public:
    /// Takes `name.weight` [out, in, kernel, kernel] and `name.bias` [out].
    conv2d(weights<Real>& source, std::string const& name, std::size_t in, std::size_t out, std::size_t kernel = 3,
           std::size_t stride = 1)
        : in_(in), kernel_(kernel), stride_(stride) {
        // Asked for before there is memory for it, so that a wrong config is told by name.
        auto const values = source.take(name + ".weight", {out, in, kernel, kernel});
        // Turn [out, in, tap] into [tap, in, out], which fits neighbourhoods gathered a whole token at a time.
        auto const taps = kernel * kernel;
        weight_.resize(static_cast<Eigen::Index>(taps * in), static_cast<Eigen::Index>(out));
        for (std::size_t o = 0; o < out; ++o) {
            for (std::size_t i = 0; i < in; ++i) {
                for (std::size_t tap = 0; tap < taps; ++tap) {
                    weight_(static_cast<Eigen::Index>(tap * in + i), static_cast<Eigen::Index>(o)) =
                        values[(o * in + i) * taps + tap];
                }
            }
        }
        bias_ = source.take(name + ".bias", {out});
    }

    std::size_t in_channels() const { return in_; }
    std::size_t out_channels() const { return bias_.size(); }

    /// The grid that comes out of one that goes in.
    grid_extents out_grid(grid_extents grid) const {
        auto const steps = [&](std::size_t extent) { return (extent + 2 * (kernel_ / 2) - kernel_) / stride_ + 1; };
        return {steps(grid.height), steps(grid.width)};
    }

    /// Writes the result [tokens of out_grid(grid), out] for `in` [tokens of grid, in]; rows of both contiguous, memory
    /// of its own for each. Throws shape_error if they do not fit.
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in, grid_extents grid) const {
        auto const to_grid = out_grid(grid);
        require_shape("conv2d", "in", in, {grid.size(), in_});
        require_shape("conv2d", "out", out, {to_grid.size(), out_channels()});
        if (kernel_ == 1 && stride_ == 1) {
            to_matrix(out).noalias() = to_matrix(in) * weight_;
        } else {
            // A tile at a time: the gathered neighbourhoods of a tile fit the cache, those of a map do not.
            auto const tile = std::max<std::size_t>(1, 65536 / static_cast<std::size_t>(weight_.rows()));
            matrix<Real> neighbourhoods(static_cast<Eigen::Index>(std::min(tile, to_grid.size())), weight_.rows());
            for (std::size_t begin = 0; begin < to_grid.size(); begin += tile) {
                auto const count = std::min(tile, to_grid.size() - begin);
                for (std::size_t i = 0; i < count; ++i) {
                    auto const token = begin + i;
                    gather(neighbourhoods.row(static_cast<Eigen::Index>(i)).data(), in, grid,
                           {static_cast<std::uint32_t>(token / to_grid.width),
                            static_cast<std::uint32_t>(token % to_grid.width)});
                }
                to_matrix(out.slice(begin, count)).noalias() =
                    neighbourhoods.topRows(static_cast<Eigen::Index>(count)) * weight_;
            }
        }
        for (std::size_t token = 0; token < out.extent(0); ++token) {
            auto const row = out[token].row();
            for (std::size_t c = 0; c < row.size(); ++c) {
                row[c] += bias_[c];
            }
        }
    }

private:
    /// Writes the inputs of all taps of one output pixel side by side.
    void gather(Real* to, in_view<Real, 2> in, grid_extents grid, pixel at) const {
        auto const radius = kernel_ / 2;
        for (std::size_t tap_row = 0; tap_row < kernel_; ++tap_row) {
            for (std::size_t tap_column = 0; tap_column < kernel_; ++tap_column, to += in_) {
                // Unsigned numbers wrap above every extent where the tap lies left of or above the map.
                auto const row = at.row * stride_ + tap_row - radius;
                auto const column = at.column * stride_ + tap_column - radius;
                if (row < grid.height && column < grid.width) {
                    std::copy_n(in[row * grid.width + column].data(), in_, to);
                } else {
                    std::fill_n(to, in_, Real(0));
                }
            }
        }
    }

    std::size_t in_;
    std::size_t kernel_;
    std::size_t stride_;
    matrix<Real> weight_;
    std::vector<Real> bias_;
};

} // namespace genrender
