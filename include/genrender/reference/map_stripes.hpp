// SPDX-License-Identifier: MIT
// A large map through a 3x3 convolution a few rows at a time, so that its padded copy is never whole.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/padded_map.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace genrender::reference {

/// How maps are run over.
struct stripe_pass {
    any_loop loop{};                                 ///< shares out rows and tokens
    std::size_t stripe_bytes = std::size_t{1} << 24; ///< about as much is read at a time; results do not depend on it

    /// Rows of a stripe of a map so wide.
    template <class Real>
    std::size_t rows(grid_extents grid, std::size_t channels) const {
        auto const row_bytes = (grid.width + 2) * std::max<std::size_t>(channels, 1) * sizeof(Real);
        return std::clamp<std::size_t>(stripe_bytes / row_bytes, 1, std::max<std::size_t>(grid.height, 1));
    }
};

/// Calls use(stripe, first, count) for stripes of rows [first, first + count) of a map, from the top down; a stripe is
/// a padded_map whose ring holds the rows above and below, or zeros where there are none. write_row(to, y) writes the
/// tokens [width, channels] of row y; each row is asked for once, and none below first + count before the stripe is
/// used, so `use` may write over the rows of its stripe where they came from.
template <class Real, class WriteRow, class Use>
void each_stripe(grid_extents grid, std::size_t channels, stripe_pass const& pass, WriteRow const& write_row,
                 Use const& use) {
    auto const rows = pass.rows<Real>(grid, channels);
    padded_map<Real> stripe({std::min(rows, grid.height), grid.width}, channels);
    auto const stride = stripe.row_stride();
    for (std::size_t first = 0; first < grid.height; first += rows) {
        auto const count = std::min(rows, grid.height - first);
        if (first > 0) {
            // The last row of the stripe before and the one below it are the first two of this one.
            auto const* const last = stripe.tokens.data() + rows * stride;
            if (count < rows) {
                padded_map<Real> shorter({count, grid.width}, channels);
                std::copy_n(last, 2 * stride, shorter.tokens.data());
                stripe = std::move(shorter);
            } else {
                std::copy(last, last + 2 * stride, stripe.tokens.data());
            }
        }
        auto const begin = first == 0 ? 0 : first + 1;
        pass.loop(first + count + 1 - begin, [&](std::size_t i) {
            auto const y = begin + i;
            auto* const to = stripe.row(y - first); // of y == first + count: in the ring
            if (y < grid.height) {
                write_row(to, y);
            } else {
                std::fill_n(to, grid.width * channels, Real{0});
            }
        });
        use(std::as_const(stripe), first, count);
    }
}

/// The same for the SiLU of the normalised map `in` [tokens of grid, channels], whose rows are contiguous. The moments
/// are those of the whole map as it is at the call.
template <class Real, class Use>
void each_normed_stripe(group_norm<Real> const& norm, in_view<Real, 2> in, grid_extents grid, stripe_pass const& pass,
                        Use const& use) {
    auto const line = norm.line_of(in, pass.loop);
    auto const width = grid.width;
    each_stripe<Real>(
        grid, norm.channels(), pass,
        [&](Real* to, std::size_t y) {
            norm.apply_silu({to, {width, norm.channels()}}, in.slice(y * width, width), line);
        },
        use);
}

/// Writes conv(silu(norm(in))) and, if there is one, `residual` [tokens, out channels], which may be `out`, into `out`
/// [tokens, out channels], which shares no memory with `in`. Rows are contiguous. Throws shape_error if they do not
/// fit.
template <class Real>
void norm_and_convolve(strided_view<Real, 2> out, group_norm<Real> const& norm, conv2d<Real> const& conv,
                       in_view<Real, 2> in, grid_extents grid, stripe_pass const& pass,
                       in_view<Real, 2> residual = {}) {
    require_shape("norm_and_convolve", "out", out, {grid.size(), conv.out_channels()});
    each_normed_stripe(norm, in, grid, pass, [&](padded_map<Real> const& stripe, std::size_t first, std::size_t count) {
        auto const begin = first * grid.width;
        auto const size = count * grid.width;
        conv(out.slice(begin, size), stripe,
             {conv.bias(), residual.data() == nullptr ? residual : residual.slice(begin, size)}, pass.loop);
    });
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
