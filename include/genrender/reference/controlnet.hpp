// SPDX-License-Identifier: MIT
// The network that looks at the depth map (Zhang et al. 2023), layer for layer diffusers' ControlNetModel.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/activation.hpp>
#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/unet_encoder.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// From a hint at image resolution to features of the latents' grid (diffusers' ControlNetConditioningEmbedding).
template <class Real>
class hint_embedding {
public:
    /// Takes `controlnet_cond_embedding.conv_in`, `.blocks.i` and `.conv_out`.
    hint_embedding(unet_config const& config, weights<Real>& source) {
        auto const name = std::string("controlnet_cond_embedding");
        auto const& channels = config.conditioning_embedding_out_channels;
        convolutions_.emplace_back(source, name + ".conv_in", config.conditioning_channels, channels.front());
        for (std::size_t i = 0; i + 1 < channels.size(); ++i) {
            auto const block = [&](std::size_t number) { return name + ".blocks." + std::to_string(number); };
            convolutions_.emplace_back(source, block(2 * i), channels[i], channels[i]);
            convolutions_.emplace_back(source, block(2 * i + 1), channels[i], channels[i + 1], 3, 2);
        }
        convolutions_.emplace_back(source, name + ".conv_out", channels.back(), config.block_out_channels.front());
    }

    /// The features of one frame [1, tokens, block_out_channels[0]] for its hint [1, pixels, conditioning_channels].
    feature_maps<Real> operator()(feature_maps<Real> const& hint) const {
        auto h = hint;
        for (std::size_t i = 0; i < convolutions_.size(); ++i) {
            feature_maps<Real> next(1, convolutions_[i].out_grid(h.grid()), convolutions_[i].out_channels());
            convolutions_[i](next[0], h[0], h.grid());
            if (i + 1 < convolutions_.size()) {
                silu(std::span(next[0].data(), next[0].size()));
            }
            h = std::move(next);
        }
        return h;
    }

private:
    std::vector<conv2d<Real>> convolutions_;
};

/// A copy of the UNet's way down, whose outputs pass 1x1 convolutions (zero before training) and are added to the
/// UNet's.
template <class Real>
class controlnet {
public:
    /// Takes every tensor of diffusers' ControlNetModel from `source` and enters its self-attention modules into
    /// `sites`. Throws value_error if the config cannot be built, file_error if a tensor is missing, misshapen or left
    /// over.
    controlnet(unet_config const& config, weights<Real>& source, site_list& sites)
        : encoder_((require_config(config), require_all_tensors(config, source), config), source, sites),
          hint_(config, source), mid_block_(source, "controlnet_mid_block", config.block_out_channels.back(),
                                            config.block_out_channels.back(), 1) {
        for (auto const channels : skip_channels(config)) {
            auto const name = "controlnet_down_blocks." + std::to_string(down_blocks_.size());
            down_blocks_.emplace_back(source, name, channels, channels, 1);
        }
        source.require_all_taken();
    }

    /// The features of a frame's hint, which depend on nothing else.
    feature_maps<Real> embed(feature_maps<Real> const& hint) const { return hint_(hint); }

    /// What to add to the UNet's skips and mid block, times `scale`, for z [frames, tokens, in_channels] at time t and
    /// one embedded hint a frame.
    encoded_maps<Real> operator()(forward_pass<Real>& pass, feature_maps<Real> const& z, Real t,
                                  std::vector<feature_maps<Real> const*> const& hints, Real scale = 1) const {
        require_extents("controlnet", "hints", std::array{hints.size()}, std::array{z.frames()});
        auto result = encoder_(pass, z, t, hints);
        if (pass.is_over) {
            return result;
        }
        for (std::size_t s = 0; s < result.skips.size(); ++s) {
            project(pass, result.skips[s], down_blocks_[s], scale);
        }
        project(pass, result.middle, mid_block_, scale);
        return result;
    }

    /// Throws file_error, naming all that is wrong at once, unless the tensors of `source` are those of this network.
    static void require_all_tensors(unet_config const& config, weights<Real> const& source) {
        require_tensors(source, [&](weights<Real>& listing) {
            site_list sites({0, 0});
            controlnet const network(config, listing, sites);
        });
    }

private:
    static void project(forward_pass<Real> const& pass, feature_maps<Real>& maps, conv2d<Real> const& conv,
                        Real scale) {
        auto result = pass.maps(maps.grid(), maps.channels());
        pass.each_frame([&](std::size_t i) {
            conv(result[i], maps[i], maps.grid(), pass.tokens());
            if (scale != 1) {
                scale_by(result[i], scale);
            }
        });
        maps = std::move(result);
    }

    unet_encoder<Real> encoder_;
    hint_embedding<Real> hint_;
    std::vector<conv2d<Real>> down_blocks_;
    conv2d<Real> mid_block_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
