// SPDX-License-Identifier: MIT
// The decoder of the autoencoder (diffusers' Decoder): a latent to its picture.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/autoencoder_config.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/linear.hpp>
#include <genrender/reference/map_stripes.hpp>
#include <genrender/reference/spare_map.hpp>
#include <genrender/reference/vae_mid_block.hpp>
#include <genrender/reference/vae_resampler.hpp>
#include <genrender/reference/vae_resnet.hpp>
#include <genrender/reference/weights.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// With use_post_quant_conv post_quant_conv, then conv_in, the mid block, levels of resnets and an upsampler, conv_out.
template <class Real>
class vae_decoder {
public:
    /// Takes all of `decoder.` and, with use_post_quant_conv, `post_quant_conv`.
    vae_decoder(autoencoder_config const& config, weights<Real>& source)
        : conv_in_(source, "decoder.conv_in", config.latent_channels, config.block_out_channels.back()),
          mid_block_(config, source, "decoder.mid_block"),
          conv_norm_out_(source, "decoder.conv_norm_out", config.block_out_channels.front(), config.norm_num_groups,
                         Real(1e-6)),
          conv_out_(source, "decoder.conv_out", config.block_out_channels.front(), 3) {
        auto in = config.block_out_channels.back();
        for (std::size_t number = 0; number < config.levels(); ++number) {
            auto const name = "decoder.up_blocks." + std::to_string(number);
            auto const out = config.block_out_channels[config.levels() - 1 - number];
            auto& made = levels_.emplace_back();
            for (std::size_t i = 0; i < config.layers_per_block + 1; ++i) {
                made.resnets.emplace_back(config, source, name + ".resnets." + std::to_string(i), in, out);
                in = out;
            }
            if (number + 1 < config.levels()) {
                made.upsampler.emplace(source, name + ".upsamplers.0", out);
            }
        }
        if (config.use_post_quant_conv) {
            post_quant_conv_.emplace(linear<Real>::of_1x1_convolution(source, "post_quant_conv", config.latent_channels,
                                                                      config.latent_channels));
        }
    }

    /// Writes the picture [3, height, width], which is about in [-1, 1] and not clamped, for a latent [tokens of its
    /// grid, latent_channels].
    void operator()(strided_view<Real, 3> picture, spare_map<Real> z, stripe_pass const& pass) const {
        if (post_quant_conv_) {
            spare_map<Real> after(z.grid(), z.channels());
            (*post_quant_conv_)(after.view(), z.view(), pass.loop);
            z = std::move(after);
        }
        spare_map<Real> x(z.grid(), conv_in_.out_channels());
        conv_in_(x.view(), z.view(), z.grid(), pass.loop);
        x = mid_block_(std::move(x), pass);
        for (auto const& level : levels_) {
            for (auto const& resnet : level.resnets) {
                x = resnet(std::move(x), pass);
            }
            if (level.upsampler) {
                x.trim();
                x = (*level.upsampler)(x, pass);
            }
        }
        auto const grid = x.grid();
        require_shape("vae_decoder", "picture", picture, {3, grid.height, grid.width});
        auto rows = stack<Real, 2>::uninitialized({pass.rows<Real>(grid, x.channels()) * grid.width, 3});
        each_normed_stripe(conv_norm_out_, x.view(), grid, pass,
                           [&](padded_map<Real> const& stripe, std::size_t first, std::size_t count) {
                               auto const out = rows.view().slice(0, count * grid.width);
                               conv_out_(out, stripe, {conv_out_.bias(), {}}, pass.loop);
                               for (std::size_t token = 0; token < out.extent(0); ++token) {
                                   for (std::size_t c = 0; c < 3; ++c) {
                                       picture(c, first + token / grid.width, token % grid.width) = out(token, c);
                                   }
                               }
                           });
    }

private:
    struct level_layers {
        std::vector<vae_resnet<Real>> resnets;
        std::optional<vae_upsampler<Real>> upsampler;
    };

    conv2d<Real> conv_in_;
    vae_mid_block<Real> mid_block_;
    std::vector<level_layers> levels_;
    group_norm<Real> conv_norm_out_;
    conv2d<Real> conv_out_;
    std::optional<linear<Real>> post_quant_conv_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
