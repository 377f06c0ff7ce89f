// SPDX-License-Identifier: MIT
// [GR sec. 3.1] Stable Diffusion in miniature: a UNet and a depth ControlNet on the CPU, a model of denoiser.
#pragma once

#include <genrender/core/parallel.hpp>
#include <genrender/models/controlnet.hpp>
#include <genrender/models/network_conditioning.hpp>
#include <genrender/models/reference_weights.hpp>
#include <genrender/models/unet.hpp>
#include <genrender/sampling/classifier_free_guidance.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/sampling/noise_schedule.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender {

/// A UNet with classifier-free guidance and a ControlNet, conditioned for one animation. Its sites are the ControlNet's
/// self-attention modules (network_kind::control) and then the UNet's, as they run. Features lie in host memory; frames
/// run through `Loop`. Copies share the weights. Runs change nothing, so several threads may run one network at once.
template <std::floating_point Real, parallel_loop Loop = sequential_loop>
class reference_network {
public:
    using real_type = Real;
    using features_type = host_features<Real>;

    /// Takes the weights of both networks (those of Stable Diffusion 1.5 and its ControlNet in diffusers' layout fit,
    /// as do weights<Real>::seeded). Throws value_error if the config cannot be built, the latents' grid cannot be
    /// halved as often as the network does, or there is no frame; shape_error if the conditioning does not fit the
    /// config; file_error naming a tensor that is missing, misshapen or left over.
    reference_network(unet_config config, weights<Real>& unet_weights, weights<Real>& control_weights,
                      network_conditioning<Real> conditioning, Loop loop = Loop())
        : config_((require_config(config), std::move(config))), conditioning_(std::move(conditioning)),
          loop_(std::move(loop)),
          schedule_(scaled_linear_alphas_cumprod(config_.beta_start, config_.beta_end, config_.num_train_timesteps)) {
        require_conditioning();
        site_list sites(latent_grid_);
        sites.begin(network_kind::control);
        control_ = std::make_shared<controlnet<Real> const>(config_, control_weights, sites);
        sites.begin(network_kind::denoiser);
        unet_ = std::make_shared<unet<Real> const>(config_, unet_weights, sites);
        sites_.assign(sites.sites().begin(), sites.sites().end());
        embed_hints();
    }

    /// The network of all its weights.
    reference_network(reference_weights<Real>& source, network_conditioning<Real> conditioning, Loop loop = Loop())
        : reference_network(source.config, source.unet, source.controlnet, std::move(conditioning), std::move(loop)) {}

    /// A network with random weights, by default the tiny one, for inverse depth [frames, height, width] in [0, 1] (see
    /// hint_of) and a text of prompt_words. Throws as the constructor and prompt_rows do.
    static reference_network seeded(strided_view<float const, 3> inverse_depth, std::string_view prompt,
                                    std::uint64_t seed, Real guidance_scale = 2, Loop loop = Loop(),
                                    unet_config const& config = {}) {
        auto source = reference_weights<Real>::seeded(seed, config);
        return {source, source.conditioning(inverse_depth, prompt, guidance_scale), std::move(loop)};
    }

    /// The network of a folder in diffusers' layout (see diffusers_folder), which says all about it; the ControlNet in
    /// a folder of its own if that is named. The text is of the words of its vocabulary. Throws as the constructor,
    /// reference_weights::from_folder and prompt_rows do.
    static reference_network from_folder(std::filesystem::path const& folder,
                                         strided_view<float const, 3> inverse_depth, std::string_view prompt,
                                         Real guidance_scale = 2, Loop loop = Loop(),
                                         std::filesystem::path const& controlnet_folder = {}) {
        auto source = reference_weights<Real>::from_folder(folder, controlnet_folder);
        return {source, source.conditioning(inverse_depth, prompt, guidance_scale), std::move(loop)};
    }

    unet_config const& config() const { return config_; }
    std::size_t latent_channels() const { return config_.in_channels; }
    grid_extents latent_grid() const { return latent_grid_; }
    std::span<attention_site const> sites() const { return sites_; }
    /// 1 with a guidance scale of 1, else 2: the empty prompt, then the prompt.
    std::size_t branches() const { return conditioning_.guidance_scale == 1 ? 1 : 2; }
    /// Number of frames it has hints for.
    std::size_t frame_count() const { return hints_.size(); }

    /// Writes D(z, sigma) [EDM eq. 7] into x0; both [frames, channels, height, width] of the latents, frames[i] being
    /// entry i's place in the animation. The estimate of a frame under plain_attention is the same to the bit whatever
    /// else is in the stack and however many threads Loop has. Throws shape_error if extents do not fit, value_error
    /// for a frame without a hint or a sigma that is not finite and at least 0.
    template <class Processor>
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto const function = "reference_network";
        require_shape(function, "z", z, {frames.size(), config_.in_channels, latent_grid_.height, latent_grid_.width});
        require_shape(function, "x0", x0,
                      {frames.size(), config_.out_channels, latent_grid_.height, latent_grid_.width});
        std::vector<feature_maps<Real> const*> hints;
        for (auto const frame : frames) {
            require_value(frame.value < hints_.size(), function, "frames", frame.value,
                          ("below " + std::to_string(hints_.size())).c_str());
            hints.push_back(&hints_[frame.value]);
        }
        auto const c_in = scalings_of(config_.prediction_type, sigma).c_in;
        feature_maps<Real> in(frames.size(), latent_grid_, config_.in_channels);
        loop_(frames.size(), [&](std::size_t i) { copy_scaled(in.channels_first()[i], z[i], c_in); });

        auto F = run(0, branches() == 1 ? conditioning_.prompt : conditioning_.empty_prompt, in, sigma, frames, hints,
                     processor);
        if (branches() == 2) {
            auto F_cond = run(1, conditioning_.prompt, in, sigma, frames, hints, processor);
            guide(F.channels_first(), F.channels_first(), F_cond.channels_first(), conditioning_.guidance_scale);
        }
        to_clean(x0, config_.prediction_type, z, F.channels_first(), sigma);
    }

private:
    void require_conditioning() {
        auto const function = "reference_network";
        auto const& hint = conditioning_.hint;
        auto const scale = config_.hint_scale();
        auto const expected = "a multiple of " + std::to_string(scale);
        require_value(hint.extent(0) > 0, function, "frames of hint", hint.extent(0), "at least 1");
        require_extents(function, "hint", hint.extents(),
                        std::array{hint.extent(0), config_.conditioning_channels, hint.extent(2), hint.extent(3)});
        require_value(hint.extent(2) % scale == 0, function, "height of hint", hint.extent(2), expected.c_str());
        require_value(hint.extent(3) % scale == 0, function, "width of hint", hint.extent(3), expected.c_str());
        latent_grid_ = {hint.extent(2) / scale, hint.extent(3) / scale};
        require_latent_grid(config_, latent_grid_);
        require_value(std::isfinite(conditioning_.guidance_scale), function, "guidance_scale",
                      conditioning_.guidance_scale, "a finite number");
        require_prompt("prompt", conditioning_.prompt);
        if (branches() == 2) {
            require_prompt("empty_prompt", conditioning_.empty_prompt);
        }
    }

    void require_prompt(char const* argument, stack<Real, 2> const& tokens) const {
        require_value(tokens.extent(0) > 0, "reference_network", argument, "empty", "at least one token");
        require_extents("reference_network", argument, tokens.extents(),
                        std::array{tokens.extent(0), config_.cross_attention_dim});
    }

    /// The embedding of a hint depends on its frame alone, so it is made once and not once a step.
    void embed_hints() {
        auto const& hint = conditioning_.hint;
        hints_.resize(hint.extent(0));
        loop_(hints_.size(), [&](std::size_t i) {
            feature_maps<Real> pixels(1, {hint.extent(2), hint.extent(3)}, hint.extent(1));
            copy(pixels.channels_first()[0], hint.view()[i]);
            hints_[i] = control_->embed(pixels);
        });
        conditioning_.hint = {};
    }

    static void copy_scaled(strided_view<Real, 3> to, strided_view<Real const, 3> from, Real factor) {
        for (std::size_t channel = 0; channel < to.extent(0); ++channel) {
            for (std::size_t row = 0; row < to.extent(1); ++row) {
                for (std::size_t column = 0; column < to.extent(2); ++column) {
                    to(channel, row, column) = factor * from(channel, row, column);
                }
            }
        }
    }

    /// The time that the network was told of during training for latents of this noise level.
    Real time_of(Real sigma) const {
        return config_.prediction_type == prediction::flow ? 1000 * flow_time_of(sigma) : schedule_.t_of(sigma);
    }

    /// The UNet's output for one guidance branch.
    template <class Processor>
    feature_maps<Real> run(std::uint32_t branch, stack<Real, 2> const& prompt, feature_maps<Real> const& in, Real sigma,
                           std::span<frame_index const> frames, std::vector<feature_maps<Real> const*> const& hints,
                           Processor& processor) const {
        forward_pass<Real, Processor, Loop> pass{frames, branch, prompt.view(), &processor, &loop_};
        auto const t = time_of(sigma);
        auto const control = (*control_)(pass, in, t, hints, conditioning_.conditioning_scale);
        return (*unet_)(pass, in, t, &control);
    }

    unet_config config_;
    network_conditioning<Real> conditioning_;
    Loop loop_;
    discrete_noise_schedule schedule_;
    grid_extents latent_grid_;
    std::vector<attention_site> sites_;
    std::shared_ptr<controlnet<Real> const> control_;
    std::shared_ptr<unet<Real> const> unet_;
    std::vector<feature_maps<Real>> hints_;
};

} // namespace genrender
