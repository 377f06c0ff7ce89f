// SPDX-License-Identifier: MIT
// Transformer blocks between feature maps (diffusers' Transformer2DModel, as in Stable Diffusion 1.x and 2.x).
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/stack.hpp>
#include <genrender/reference/feature_maps.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/transformer_block.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace genrender::reference {

/// x + proj_out(blocks(proj_in(norm(x)))). The projections are 1x1 convolutions, or matrices, which is the same but for
/// the shape of their tensors.
template <class Real>
class spatial_transformer {
public:
    /// Takes `name.norm`, `.proj_in`, `.transformer_blocks.i` and `.proj_out`.
    spatial_transformer(unet_config const& config, weights<Real>& source, site_list& sites, std::string const& name,
                        std::size_t level, network_part part)
        : norm_(source, name + ".norm", config.block_out_channels[level], config.norm_num_groups, Real(1e-6)),
          proj_in_(projection(config, source, name + ".proj_in", config.block_out_channels[level])),
          proj_out_(projection(config, source, name + ".proj_out", config.block_out_channels[level])) {
        for (std::size_t i = 0; i < config.transformer_layers_per_block; ++i) {
            blocks_.emplace_back(config, source, sites, name + ".transformer_blocks." + std::to_string(i), level, part);
        }
    }

    /// Runs in place of x [frames, tokens, channels].
    void operator()(forward_pass<Real> const& pass, feature_maps<Real>& x) const {
        auto h = pass.maps(x.grid(), x.channels());
        pass.each_frame([&](std::size_t i) {
            auto normed = stack<Real, 2>::uninitialized(x[i].extents());
            norm_(normed.view(), x[i], pass.tokens());
            proj_in_(h[i], normed, pass.tokens());
        });
        for (auto const& block : blocks_) {
            block(pass, h);
            if (pass.is_over) {
                return;
            }
        }
        pass.each_frame([&](std::size_t i) { proj_out_.add_to(x[i], h[i], pass.tokens()); });
    }

private:
    static linear<Real> projection(unet_config const& config, weights<Real>& source, std::string const& name,
                                   std::size_t channels) {
        return config.use_linear_projection ? linear<Real>(source, name, channels, channels)
                                            : linear<Real>::of_1x1_convolution(source, name, channels, channels);
    }

    group_norm<Real> norm_;
    linear<Real> proj_in_;
    linear<Real> proj_out_;
    std::vector<transformer_block<Real>> blocks_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
