// SPDX-License-Identifier: MIT
// Convolution with 3x3 or 1x1 kernels as one matrix product over neighbourhoods that are read where they lie.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/padded_map.hpp>
#include <genrender/reference/panel_source.hpp>
#include <genrender/reference/weight_panels.hpp>
#include <genrender/reference/weights.hpp>

#include <array>
#include <cassert>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace genrender::reference {

/// A convolution, strictly a cross-correlation, of feature maps [tokens, channels] with zeros around them: kernel k (1
/// or 3), padding k / 2, stride 1 or more.
template <class Real>
class conv2d {
public:
    /// Takes `name.weight` [out, in, kernel, kernel] and `name.bias` [out].
    conv2d(weights<Real>& source, std::string const& name, std::size_t in, std::size_t out, std::size_t kernel = 3,
           std::size_t stride = 1)
        : in_(in), kernel_(kernel), stride_(stride) {
        // Turn [out, in, tap] into [tap, in, out]: the channels of a token lie side by side.
        auto const taps = kernel * kernel;
        weights_ =
            take_panels(source, name + ".weight", {out, in, kernel, kernel}, taps * in, out,
                        [&](std::size_t input, std::size_t o) { return (o * in + input % in) * taps + input / in; });
        bias_ = source.take(name + ".bias", {out});
    }

    /// Channels that it takes.
    std::size_t in_channels() const { return in_; }
    /// Channels that it gives.
    std::size_t out_channels() const { return weights_.outputs(); }
    /// Of each output channel.
    std::span<Real const> bias() const { return bias_; }

    /// The grid that comes out of one that goes in.
    grid_extents out_grid(grid_extents grid) const {
        auto const steps = [&](std::size_t extent) { return (extent + 2 * (kernel_ / 2) - kernel_) / stride_ + 1; };
        return {steps(grid.height), steps(grid.width)};
    }

    /// Writes the result [tokens of out_grid(grid), out] for `in` [tokens of grid, in]; rows of both contiguous, memory
    /// of its own for each. Tokens are shared out over `loop`. Throws shape_error if they do not fit.
    void operator()(strided_view<Real, 2> out, in_view<Real, 2> in, grid_extents grid,
                    any_loop const& loop = {}) const {
        require_shape("conv2d", "in", in, {grid.size(), in_});
        if (kernel_ > 1) {
            (*this)(out, padded_map<Real>(in, grid), {bias_}, loop);
            return;
        }
        auto const to_grid = out_grid(grid);
        require_shape("conv2d", "out", out, {to_grid.size(), out_channels()});
        auto const token = static_cast<std::ptrdiff_t>(stride_) * in.stride(0);
        weights_.multiply(out,
                          {in.data(), to_grid.width, token, static_cast<std::ptrdiff_t>(grid.width) * token, 1, in_, 0},
                          {bias_}, loop);
    }

    /// Writes the result of a 3x3 kernel for a map that lies in its ring already. `terms` are all that is added to the
    /// products: bias() or what stands for it, and a residual. Throws shape_error if they do not fit.
    void operator()(strided_view<Real, 2> out, padded_map<Real> const& in, product_terms<Real> const& terms,
                    any_loop const& loop = {}) const {
        assert(kernel_ == 3 && "conv2d: a padded map is for kernels of 3");
        auto const to_grid = out_grid(in.grid());
        require_extents("conv2d", "channels of in", std::array{in.channels()}, std::array{in_});
        require_shape("conv2d", "out", out, {to_grid.size(), out_channels()});
        auto const row = static_cast<std::ptrdiff_t>(in.row_stride());
        weights_.multiply(out,
                          {in.corner(), to_grid.width, static_cast<std::ptrdiff_t>(stride_ * in_),
                           static_cast<std::ptrdiff_t>(stride_) * row, 3, 3 * in_, row},
                          terms, loop);
    }

private:
    std::size_t in_;
    std::size_t kernel_;
    std::size_t stride_;
    weight_panels<Real> weights_;
    std::vector<Real> bias_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
