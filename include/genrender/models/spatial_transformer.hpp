// SPDX-License-Identifier: MIT
// A transformer block between feature maps (diffusers' Transformer2DModel, as in Stable Diffusion 1.5).
#pragma once

#include <genrender/models/conv2d.hpp>
#include <genrender/models/feature_maps.hpp>
#include <genrender/models/forward_pass.hpp>
#include <genrender/models/group_norm.hpp>
#include <genrender/models/transformer_block.hpp>

#include <cstddef>
#include <string>

namespace genrender {

/// x + proj_out(block(proj_in(norm(x)))).
template <class Real>
class spatial_transformer {
public:
    /// Takes `name.norm`, `.proj_in`, `.transformer_blocks.0` and `.proj_out`.
    spatial_transformer(unet_config const& config, weights<Real>& source, site_list& sites, std::string const& name,
                        std::size_t level, network_part part)
        : norm_(source, name + ".norm", config.block_out_channels[level], config.norm_num_groups, Real(1e-6)),
          proj_in_(source, name + ".proj_in", config.block_out_channels[level], config.block_out_channels[level], 1),
          block_(config, source, sites, name + ".transformer_blocks.0", level, part),
          proj_out_(source, name + ".proj_out", config.block_out_channels[level], config.block_out_channels[level], 1) {
    }

    /// Runs in place of x [frames, tokens, channels].
    template <class Pass>
    void operator()(Pass const& pass, feature_maps<Real>& x) const {
        auto h = pass.maps(x.grid(), x.channels());
        pass.each_frame([&](std::size_t i) {
            stack<Real, 2> normed(x[i].extents());
            norm_(normed.view(), x[i]);
            proj_in_(h[i], normed, x.grid());
        });
        block_(pass, h);
        pass.each_frame([&](std::size_t i) {
            stack<Real, 2> out(x[i].extents());
            proj_out_(out.view(), h[i], x.grid());
            add_scaled(x[i], out);
        });
    }

private:
    group_norm<Real> norm_;
    conv2d<Real> proj_in_;
    transformer_block<Real> block_;
    conv2d<Real> proj_out_;
};

} // namespace genrender
