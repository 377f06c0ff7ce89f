// SPDX-License-Identifier: MIT
// The encoder of the autoencoder (diffusers' Encoder): a picture to the moments of its latent.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/stack.hpp>
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

/// conv_in, levels of resnets and a downsampler, the mid block, conv_out and, with use_quant_conv, quant_conv.
template <class Real>
class vae_encoder {
public:
    /// Takes all of `encoder.` and, with use_quant_conv, `quant_conv`.
    vae_encoder(autoencoder_config const& config, weights<Real>& source)
        : conv_in_(source, "encoder.conv_in", 3, config.block_out_channels.front()),
          mid_block_(config, source, "encoder.mid_block"),
          conv_norm_out_(source, "encoder.conv_norm_out", config.block_out_channels.back(), config.norm_num_groups,
                         Real(1e-6)),
          conv_out_(source, "encoder.conv_out", config.block_out_channels.back(), 2 * config.latent_channels) {
        auto in = config.block_out_channels.front();
        for (std::size_t number = 0; number < config.levels(); ++number) {
            auto const name = "encoder.down_blocks." + std::to_string(number);
            auto const out = config.block_out_channels[number];
            auto& made = levels_.emplace_back();
            for (std::size_t i = 0; i < config.layers_per_block; ++i) {
                made.resnets.emplace_back(config, source, name + ".resnets." + std::to_string(i), in, out);
                in = out;
            }
            if (number + 1 < config.levels()) {
                made.downsampler.emplace(source, name + ".downsamplers.0", out);
            }
        }
        if (config.use_quant_conv) {
            quant_conv_.emplace(linear<Real>::of_1x1_convolution(source, "quant_conv", 2 * config.latent_channels,
                                                                 2 * config.latent_channels));
        }
    }

    /// Means and log variances [tokens of the latent, 2 latent_channels] of a picture [tokens of its grid, 3], whose
    /// extents can be halved as often as there are downsamplers.
    spare_map<Real> operator()(spare_map<Real> const& picture, stripe_pass const& pass) const {
        spare_map<Real> x(picture.grid(), conv_in_.out_channels());
        conv_in_(x.view(), picture.view(), picture.grid(), pass.loop);
        for (auto const& level : levels_) {
            for (auto const& resnet : level.resnets) {
                x = resnet(std::move(x), pass);
            }
            if (level.downsampler) {
                x = (*level.downsampler)(x, pass);
            }
        }
        x = mid_block_(std::move(x), pass);
        spare_map<Real> moments(x.grid(), conv_out_.out_channels());
        norm_and_convolve(moments.view(), conv_norm_out_, conv_out_, x.view(), x.grid(), pass);
        if (!quant_conv_) {
            return moments;
        }
        spare_map<Real> result(x.grid(), moments.channels());
        (*quant_conv_)(result.view(), moments.view(), pass.loop);
        return result;
    }

private:
    struct level_layers {
        std::vector<vae_resnet<Real>> resnets;
        std::optional<vae_downsampler<Real>> downsampler;
    };

    conv2d<Real> conv_in_;
    std::vector<level_layers> levels_;
    vae_mid_block<Real> mid_block_;
    group_norm<Real> conv_norm_out_;
    conv2d<Real> conv_out_;
    std::optional<linear<Real>> quant_conv_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
