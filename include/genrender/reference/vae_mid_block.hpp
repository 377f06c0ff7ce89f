// SPDX-License-Identifier: MIT
// The bottom of the autoencoder's encoder and decoder (diffusers' UNetMidBlock2D).
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/autoencoder_config.hpp>
#include <genrender/reference/map_stripes.hpp>
#include <genrender/reference/spare_map.hpp>
#include <genrender/reference/vae_attention.hpp>
#include <genrender/reference/vae_resnet.hpp>
#include <genrender/reference/weights.hpp>

#include <optional>
#include <string>
#include <utility>

namespace genrender::reference {

/// A resnet, attention where the config has it, a resnet, at the channels of the coarsest level.
template <class Real>
class vae_mid_block {
public:
    /// Takes `name.resnets.0`, `.resnets.1` and, with mid_block_add_attention, `.attentions.0`.
    vae_mid_block(autoencoder_config const& config, weights<Real>& source, std::string const& name)
        : first_(config, source, name + ".resnets.0", config.block_out_channels.back(),
                 config.block_out_channels.back()),
          last_(config, source, name + ".resnets.1", config.block_out_channels.back(),
                config.block_out_channels.back()) {
        if (config.mid_block_add_attention) {
            attention_.emplace(config, source, name + ".attentions.0", config.block_out_channels.back());
        }
    }

    /// The block's output on the grid of x, in its memory.
    spare_map<Real> operator()(spare_map<Real> x, stripe_pass const& pass) const {
        x = first_(std::move(x), pass);
        if (attention_) {
            (*attention_)(x, pass);
        }
        return last_(std::move(x), pass);
    }

private:
    vae_resnet<Real> first_;
    std::optional<vae_attention<Real>> attention_;
    vae_resnet<Real> last_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
