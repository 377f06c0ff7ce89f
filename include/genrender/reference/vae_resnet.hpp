// SPDX-License-Identifier: MIT
// The residual block of the autoencoder (diffusers' ResnetBlock2D without time), in little more memory than its input.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/autoencoder_config.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/map_stripes.hpp>
#include <genrender/reference/spare_map.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

namespace genrender::reference {

/// shortcut(x) + conv2(silu(norm2(conv1(silu(norm1(x)))))); the shortcut is a 1x1 convolution where the number of
/// channels changes, else x itself.
template <class Real>
class vae_resnet {
public:
    /// Takes `name.norm1`, `.conv1`, `.norm2`, `.conv2` and, where channels change, `.conv_shortcut`.
    vae_resnet(autoencoder_config const& config, weights<Real>& source, std::string const& name, std::size_t in,
               std::size_t out)
        : norm1_(source, name + ".norm1", in, config.norm_num_groups, Real(1e-6)),
          conv1_(source, name + ".conv1", in, out),
          norm2_(source, name + ".norm2", out, config.norm_num_groups, Real(1e-6)),
          conv2_(source, name + ".conv2", out, out) {
        if (in != out) {
            conv_shortcut_.emplace(source, name + ".conv_shortcut", in, out, 1);
        }
    }

    /// Channels that it gives.
    std::size_t out_channels() const { return conv2_.out_channels(); }

    /// The block's output on the grid of x, in x's memory where that is large enough. Throws shape_error if x has other
    /// channels.
    spare_map<Real> operator()(spare_map<Real> x, stripe_pass const& pass) const {
        auto const grid = x.grid();
        if (!conv_shortcut_) {
            stack<Real, 1> storage;
            auto const hidden = x.scratch(storage);
            norm_and_convolve(hidden, norm1_, conv1_, x.view(), grid, pass);
            norm_and_convolve(x.view(), norm2_, conv2_, hidden, grid, pass, x.view());
            return x;
        }
        if (x.channels() >= 2 * out_channels()) {
            return narrowed(std::move(x), pass);
        }
        auto hidden = stack<Real, 2>::uninitialized({grid.size(), out_channels()});
        norm_and_convolve(hidden.view(), norm1_, conv1_, x.view(), grid, pass);
        spare_map<Real> result(grid, out_channels());
        (*conv_shortcut_)(result.view(), x.view(), grid, pass.loop);
        x = {};
        norm_and_convolve(result.view(), norm2_, conv2_, hidden, grid, pass, result.view());
        return result;
    }

private:
    /// Of at most half the channels: a token's hidden features and its shortcut take the place of its input.
    spare_map<Real> narrowed(spare_map<Real> x, stripe_pass const& pass) const {
        auto const grid = x.grid();
        auto const in = x.channels();
        auto const all = x.view();
        strided_view<Real, 2> const hidden(all.data(), {grid.size(), out_channels()}, all.strides());
        strided_view<Real, 2> const result(all.data() + out_channels(), hidden.extents(), all.strides());
        each_normed_stripe(norm1_, x.view(), grid, pass,
                           [&](padded_map<Real> const& stripe, std::size_t first, std::size_t count) {
                               auto const begin = first * grid.width;
                               auto const size = count * grid.width;
                               auto before = stack<Real, 2>::uninitialized({size, in});
                               std::copy_n(all[begin].data(), size * in, before.data());
                               (*conv_shortcut_)(result.slice(begin, size), before, {count, grid.width}, pass.loop);
                               conv1_(hidden.slice(begin, size), stripe, {conv1_.bias(), {}}, pass.loop);
                           });
        norm_and_convolve(result, norm2_, conv2_, hidden, grid, pass, result);
        x.keep_channels(out_channels(), out_channels());
        return x;
    }

    group_norm<Real> norm1_;
    conv2d<Real> conv1_;
    group_norm<Real> norm2_;
    conv2d<Real> conv2_;
    std::optional<conv2d<Real>> conv_shortcut_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
