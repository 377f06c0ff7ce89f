// SPDX-License-Identifier: MIT
// The residual block of the UNet (diffusers' ResnetBlock2D): two convolutions, told of the time between them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/stack.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/feature_maps.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/padded_map.hpp>
#include <genrender/reference/unet_config.hpp>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace genrender::reference {

/// shortcut(x) + conv2(silu(norm2(conv1(silu(norm1(x))) + W time))); the shortcut is a 1x1 convolution where the number
/// of channels changes, else x itself.
template <class Real>
class resnet_block {
public:
    /// Takes `name.norm1`, `.conv1`, `.time_emb_proj`, `.norm2`, `.conv2` and, where channels change, `.conv_shortcut`.
    resnet_block(unet_config const& config, weights<Real>& source, std::string const& name, std::size_t in,
                 std::size_t out)
        : norm1_(source, name + ".norm1", in, config.norm_num_groups, Real(1e-5)),
          conv1_(source, name + ".conv1", in, out),
          time_emb_proj_(source, name + ".time_emb_proj", config.time_channels(), out),
          norm2_(source, name + ".norm2", out, config.norm_num_groups, Real(1e-5)),
          conv2_(source, name + ".conv2", out, out) {
        if (in != out) {
            conv_shortcut_.emplace(source, name + ".conv_shortcut", in, out, 1);
        }
    }

    /// Channels that it gives.
    std::size_t out_channels() const { return conv2_.out_channels(); }

    /// The block's output [frames, tokens, out] on the grid of x.
    feature_maps<Real> operator()(forward_pass<Real> const& pass, feature_maps<Real> const& x) const {
        auto result = pass.maps(x.grid(), out_channels());
        // The same for all tokens: conv1's bias and what it is told of the time.
        std::vector<Real> shift(out_channels());
        time_emb_proj_(strided_view<Real, 2>(shift.data(), {1, shift.size()}),
                       strided_view<Real const, 2>(pass.time.data(), {1, pass.time.size()}));
        std::transform(shift.begin(), shift.end(), conv1_.bias().begin(), shift.begin(), std::plus<Real>());
        pass.each_frame([&](std::size_t i) { run(result[i], x[i], x.grid(), shift, pass.tokens()); });
        return result;
    }

private:
    void run(strided_view<Real, 2> out, in_view<Real, 2> x, grid_extents grid, std::span<Real const> shift,
             any_loop const& loop) const {
        auto hidden = stack<Real, 2>::uninitialized(out.extents());
        {
            padded_map<Real> normed(grid, x.extent(1));
            norm1_.with_silu(normed, x, loop);
            conv1_(hidden.view(), normed, {shift, {}}, loop);
        }
        padded_map<Real> normed(grid, out.extent(1));
        norm2_.with_silu(normed, hidden, loop);
        if (conv_shortcut_) {
            (*conv_shortcut_)(out, x, grid, loop);
            conv2_(out, normed, {conv2_.bias(), out}, loop);
        } else {
            conv2_(out, normed, {conv2_.bias(), x}, loop);
        }
    }

    group_norm<Real> norm1_;
    conv2d<Real> conv1_;
    linear<Real> time_emb_proj_;
    group_norm<Real> norm2_;
    conv2d<Real> conv2_;
    std::optional<conv2d<Real>> conv_shortcut_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
