// SPDX-License-Identifier: MIT
// The denoising UNet of Stable Diffusion (Rombach et al. 2022), layer for layer diffusers' UNet2DConditionModel.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/group_norm.hpp>
#include <genrender/reference/padded_map.hpp>
#include <genrender/reference/unet_encoder.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// One level of the way up (diffusers' UpBlock2D and CrossAttnUpBlock2D).
template <class Real>
class up_block {
public:
    /// Block `number` of the way up, at level levels - 1 - number. Takes `up_blocks.number.resnets.i`, `.attentions.i`
    /// and, except at the finest level, `.upsamplers.0`.
    up_block(unet_config const& config, weights<Real>& source, site_list& sites, std::size_t number) {
        auto const name = "up_blocks." + std::to_string(number);
        auto const level = config.levels() - 1 - number;
        auto const out = config.block_out_channels[level];
        auto const skips = skip_channels(config);
        auto const resnets = config.layers_per_block + 1;
        auto in = number == 0 ? out : config.block_out_channels[level + 1];
        for (std::size_t i = 0; i < resnets; ++i) {
            auto const skip = skips[skips.size() - 1 - number * resnets - i];
            auto const index = "." + std::to_string(i);
            resnets_.emplace_back(config, source, name + ".resnets" + index, in + skip, out);
            if (config.has_attention_up(level)) {
                attentions_.emplace_back(config, source, sites, name + ".attentions" + index, level,
                                         network_part::decoder);
            }
            in = out;
        }
        if (level > 0) {
            upsampler_.emplace(source, name + ".upsamplers.0", out);
        }
    }

    /// Runs h, joined by the last of the skips before each resnet; removes them from the list.
    feature_maps<Real> operator()(forward_pass<Real> const& pass, feature_maps<Real> h,
                                  std::vector<feature_maps<Real>>& skips) const {
        for (std::size_t i = 0; i < resnets_.size(); ++i) {
            auto const skip = std::move(skips.back());
            skips.pop_back();
            auto joined = pass.maps(h.grid(), h.channels() + skip.channels());
            pass.each_frame([&](std::size_t frame) { concatenate(joined[frame], h[frame], skip[frame]); });
            h = resnets_[i](pass, joined);
            if (!attentions_.empty()) {
                attentions_[i](pass, h);
                if (pass.is_over) {
                    return h;
                }
            }
        }
        return upsampler_ ? (*upsampler_)(pass, h) : std::move(h);
    }

private:
    std::vector<resnet_block<Real>> resnets_;
    std::vector<spatial_transformer<Real>> attentions_;
    std::optional<upsampler<Real>> upsampler_;
};

/// The network that predicts the latents.
template <class Real>
class unet {
public:
    /// Takes every tensor of diffusers' UNet2DConditionModel from `source` and enters its self-attention modules into
    /// `sites`. Throws value_error if the config cannot be built, file_error if a tensor is missing, misshapen or left
    /// over.
    unet(unet_config const& config, weights<Real>& source, site_list& sites)
        : encoder_((require_config(config), require_all_tensors(config, source), config), source, sites),
          conv_norm_out_(source, "conv_norm_out", config.block_out_channels.front(), config.norm_num_groups,
                         Real(1e-5)),
          conv_out_(source, "conv_out", config.block_out_channels.front(), config.out_channels) {
        for (std::size_t number = 0; number < config.levels(); ++number) {
            up_blocks_.emplace_back(config, source, sites, number);
        }
        source.require_all_taken();
    }

    /// The network's output [frames, tokens, out_channels] for z [frames, tokens, in_channels] at time t. `control`, if
    /// there is one, is added to the skips and to the output of the mid block.
    feature_maps<Real> operator()(forward_pass<Real>& pass, feature_maps<Real> const& z, Real t,
                                  encoded_maps<Real> const* control = nullptr) const {
        return decode(pass, encode(pass, z, t, control));
    }

    /// The first half of it: the way down and the mid block. Leaves the embedding of t in `pass.time`.
    encoded_maps<Real> encode(forward_pass<Real>& pass, feature_maps<Real> const& z, Real t,
                              encoded_maps<Real> const* control = nullptr) const {
        auto encoded = encoder_(pass, z, t);
        if (control != nullptr && !pass.is_over) {
            auto& skips = encoded.skips;
            require_extents("unet", "control", std::array{control->skips.size()}, std::array{skips.size()});
            for (std::size_t s = 0; s < skips.size(); ++s) {
                add(pass, skips[s], control->skips[s]);
            }
            add(pass, encoded.middle, control->middle);
        }
        return encoded;
    }

    /// The second half: the way up, from what the first half gave, with its `pass.time`.
    feature_maps<Real> decode(forward_pass<Real> const& pass, encoded_maps<Real> encoded) const {
        auto& skips = encoded.skips;
        auto h = std::move(encoded.middle);
        for (auto const& block : up_blocks_) {
            h = block(pass, std::move(h), skips);
            if (pass.is_over) {
                return h;
            }
        }
        auto result = pass.maps(h.grid(), conv_out_.out_channels());
        pass.each_frame([&](std::size_t i) {
            padded_map<Real> normed(h.grid(), h.channels());
            conv_norm_out_.with_silu(normed, std::as_const(h)[i], pass.tokens());
            conv_out_(result[i], normed, {conv_out_.bias()}, pass.tokens());
        });
        return result;
    }

    /// Throws file_error, naming all that is wrong at once, unless the tensors of `source` are those of this network.
    static void require_all_tensors(unet_config const& config, weights<Real> const& source) {
        require_tensors(source, [&](weights<Real>& listing) {
            site_list sites({0, 0});
            unet const network(config, listing, sites);
        });
    }

private:
    static void add(forward_pass<Real> const& pass, feature_maps<Real>& to, feature_maps<Real> const& from) {
        pass.each_frame([&](std::size_t i) { add_scaled(to[i], from[i]); });
    }

    unet_encoder<Real> encoder_;
    std::vector<up_block<Real>> up_blocks_;
    group_norm<Real> conv_norm_out_;
    conv2d<Real> conv_out_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
