// SPDX-License-Identifier: MIT
// The way down and the bottom of the UNet, which the ControlNet has too.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/conv2d.hpp>
#include <genrender/reference/feature_maps.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/resampler.hpp>
#include <genrender/reference/resnet_block.hpp>
#include <genrender/reference/spatial_transformer.hpp>
#include <genrender/reference/time_embedding.hpp>
#include <genrender/reference/unet_config.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// What comes out of the way down.
template <class Real>
struct encoded_maps {
    std::vector<feature_maps<Real>>
        skips;                 ///< after conv_in, each resnet (and its attention), each downsampler, in that order
    feature_maps<Real> middle; ///< after the mid block
};

/// One level of the way down (diffusers' DownBlock2D and CrossAttnDownBlock2D).
template <class Real>
class down_block {
public:
    /// Takes `name.resnets.i`, `name.attentions.i` and, except at the last level, `name.downsamplers.0`.
    down_block(unet_config const& config, weights<Real>& source, site_list& sites, std::size_t level) {
        auto const name = "down_blocks." + std::to_string(level);
        auto const out = config.block_out_channels[level];
        auto in = level == 0 ? out : config.block_out_channels[level - 1];
        for (std::size_t i = 0; i < config.layers_per_block; ++i) {
            auto const number = "." + std::to_string(i);
            resnets_.emplace_back(config, source, name + ".resnets" + number, in, out);
            if (config.level_has_attention[level]) {
                attentions_.emplace_back(config, source, sites, name + ".attentions" + number, level,
                                         network_part::encoder);
            }
            in = out;
        }
        if (level + 1 < config.levels()) {
            downsampler_.emplace(source, name + ".downsamplers.0", out);
        }
    }

    /// Goes on from the last of the skips and appends to them.
    void operator()(forward_pass<Real> const& pass, std::vector<feature_maps<Real>>& skips) const {
        for (std::size_t i = 0; i < resnets_.size(); ++i) {
            auto h = resnets_[i](pass, skips.back());
            if (!attentions_.empty()) {
                attentions_[i](pass, h);
            }
            skips.push_back(std::move(h));
            if (pass.is_over) {
                return;
            }
        }
        if (downsampler_) {
            skips.push_back((*downsampler_)(pass, skips.back()));
        }
    }

private:
    std::vector<resnet_block<Real>> resnets_;
    std::vector<spatial_transformer<Real>> attentions_;
    std::optional<downsampler<Real>> downsampler_;
};

/// conv_in, the embedding of time, the down blocks and the mid block (diffusers' UNetMidBlock2DCrossAttn).
template <class Real>
class unet_encoder {
public:
    /// Takes `conv_in`, `time_embedding`, `down_blocks.i` and `mid_block`.
    unet_encoder(unet_config const& config, weights<Real>& source, site_list& sites)
        : conv_in_(source, "conv_in", config.in_channels, config.block_out_channels.front()), time_(config, source) {
        for (std::size_t level = 0; level < config.levels(); ++level) {
            down_blocks_.emplace_back(config, source, sites, level);
        }
        auto const last = config.levels() - 1;
        auto const channels = config.block_out_channels[last];
        mid_resnets_.emplace_back(config, source, "mid_block.resnets.0", channels, channels);
        mid_attention_.emplace(config, source, sites, "mid_block.attentions.0", last, network_part::middle);
        mid_resnets_.emplace_back(config, source, "mid_block.resnets.1", channels, channels);
    }

    /// Runs z [frames, tokens, in_channels] at time t; `hint` [frames, tokens, block_out_channels[0]], if there is one,
    /// is added after conv_in. Leaves the embedding of t in `pass.time`.
    encoded_maps<Real> operator()(forward_pass<Real>& pass, feature_maps<Real> const& z, Real t,
                                  std::vector<feature_maps<Real> const*> const& hint = {}) const {
        pass.time = time_(t);
        encoded_maps<Real> result;
        auto h = pass.maps(z.grid(), conv_in_.out_channels());
        pass.each_frame([&](std::size_t i) {
            conv_in_(h[i], z[i], z.grid(), pass.tokens());
            if (!hint.empty()) {
                add_scaled(h[i], (*hint[i])[0]);
            }
        });
        result.skips.push_back(std::move(h));
        for (auto const& block : down_blocks_) {
            block(pass, result.skips);
            if (pass.is_over) {
                return result;
            }
        }
        result.middle = mid_resnets_[0](pass, result.skips.back());
        (*mid_attention_)(pass, result.middle);
        if (pass.is_over) {
            return result;
        }
        result.middle = mid_resnets_[1](pass, result.middle);
        return result;
    }

private:
    conv2d<Real> conv_in_;
    time_embedding<Real> time_;
    std::vector<down_block<Real>> down_blocks_;
    std::vector<resnet_block<Real>> mid_resnets_;
    std::optional<spatial_transformer<Real>> mid_attention_;
};

/// Channels of each of the encoder's skips, in their order.
inline std::vector<std::size_t> skip_channels(unet_config const& config) {
    std::vector<std::size_t> channels{config.block_out_channels.front()};
    for (std::size_t level = 0; level < config.levels(); ++level) {
        auto const count = config.layers_per_block + (level + 1 < config.levels() ? 1 : 0);
        channels.insert(channels.end(), count, config.block_out_channels[level]);
    }
    return channels;
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
