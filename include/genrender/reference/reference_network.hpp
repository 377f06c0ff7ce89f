// SPDX-License-Identifier: MIT
// [GR sec. 3.1] Stable Diffusion's UNet and a ControlNet for depth on the CPU, in any size: a model of denoiser.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/keyframes/stoppable_denoiser.hpp>
#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/embedded_hints.hpp>
#include <genrender/reference/encoded_frames.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/network_conditioning.hpp>
#include <genrender/reference/site_list.hpp>
#include <genrender/reference/unet.hpp>
#include <genrender/reference/unet_config.hpp>
#include <genrender/reference/weights.hpp>
#include <genrender/sampling/classifier_free_guidance.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/sampling/noise_schedule.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// A UNet with classifier-free guidance and a ControlNet, conditioned for one animation. Its sites are the ControlNet's
/// self-attention modules (network_kind::control) and then the UNet's, as they run. Features lie in host memory; frames
/// run through `loop`. Copies share the weights. Runs change nothing, so several threads may run one network at once.
/// It can end a call early and lends what the decoder starts from (stoppable_denoiser, residual_lender).
template <std::floating_point Real>
class reference_network {
public:
    using real_type = Real;                      ///< float or double, in which it computes
    using features_type = host_features<Real>;   ///< features in host memory
    using residuals_type = encoded_frames<Real>; ///< what the encoder leaves to the decoder

    /// Takes the weights of both networks: those of files (stable_diffusion makes the network of a whole pipeline), or
    /// random ones (weights::seeded). Throws value_error if the config cannot be built, the latents' grid cannot be
    /// halved as often as the network does, or there is no frame; shape_error if the conditioning does not fit the
    /// config; file_error naming a tensor that is missing, misshapen or left over. Embedded hints are kept of as many
    /// frames as fit into `hint_bytes`, so that memory does not grow with the animation; others are embedded anew in
    /// each call, with the same result.
    reference_network(unet_config config, weights<Real>& unet_weights, weights<Real>& control_weights,
                      network_conditioning<Real> conditioning, any_loop loop = {},
                      std::size_t hint_bytes = std::size_t{1} << 26)
        : config_((require_config(config), std::move(config))), conditioning_(std::move(conditioning)),
          loop_(std::move(loop)),
          schedule_(scaled_linear_alphas_cumprod(config_.beta_start, config_.beta_end, config_.num_train_timesteps)) {
        require_conditioning();
        site_list sites(latent_grid_);
        sites.begin(network_kind::control);
        control_ = std::make_shared<controlnet<Real> const>(config_, control_weights, sites);
        sites.begin(network_kind::denoising);
        unet_ = std::make_shared<unet<Real> const>(config_, unet_weights, sites);
        sites_.assign(sites.sites().begin(), sites.sites().end());
        hints_ = {control_, std::exchange(conditioning_.hint, {}), hint_bytes, loop_};
    }

    /// The architecture that its weights are for.
    unet_config const& config() const { return config_; }
    /// Channels of a latent.
    std::size_t latent_channels() const { return config_.in_channels; }
    /// Height and width of a latent.
    grid_extents latent_grid() const { return latent_grid_; }
    /// Its self-attention modules, in the order in which they run.
    std::span<attention_site const> sites() const { return sites_; }
    /// 1 with a guidance scale of 1, else 2: the empty prompt, then the prompt.
    std::size_t branches() const { return conditioning_.guidance_scale == 1 ? 1 : 2; }
    /// Number of frames it has hints for.
    std::size_t frame_count() const { return hints_.frame_count(); }

    /// Writes D(z, sigma) [EDM eq. 7] into x0; both [frames, channels, height, width] of the latents, frames[i] being
    /// entry i's place in the animation. The estimate of a frame under plain_attention is the same to the bit whatever
    /// else is in the stack and however many threads `loop` has. Throws shape_error if extents do not fit, value_error
    /// for a frame without a hint or a sigma that is not finite and at least 0.
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, any_processor<Real> processor) const {
        (*this)(x0, z, sigma, frames, processor, residuals_type{});
    }

    /// The same to the bit, in less time for frames whose way down `lent` holds.
    void operator()(strided_view<Real, 4> x0, strided_view<Real const, 4> z, Real sigma,
                    std::span<frame_index const> frames, any_processor<Real> processor,
                    residuals_type const& lent) const {
        require_shape("reference_network", "x0", x0,
                      {frames.size(), config_.out_channels, latent_grid_.height, latent_grid_.width});
        auto in = frames_of(z, sigma, frames);
        auto const run = [&](std::uint32_t branch) {
            auto pass = pass_of(branch, in, processor);
            auto known = is_plain_before_decoder(processor, branch)
                             ? lent.find(branch, frames, z, sigma)
                             : std::optional<typename residuals_type::of_branch>{};
            if (!known) {
                return unet_->decode(pass, encode(pass, in));
            }
            pass.time = std::move(known->time);
            return unet_->decode(pass, std::move(known->maps));
        };
        auto F = run(0);
        if (branches() == 2) {
            auto F_cond = run(1);
            guide(F.channels_first(), F.channels_first(), F_cond.channels_first(), conditioning_.guidance_scale);
            rescale_guidance(F.channels_first(), F_cond.channels_first(), conditioning_.guidance_rescale);
        }
        to_clean(x0, config_.prediction_type, z, F.channels_first(), sigma);
    }

    /// Runs the processor as a call does, in each branch up to its last site and no further; a branch without one does
    /// not run. If `lent` is not null it becomes what the decoder starts from, of the branches in which the processor
    /// is plain before. Throws as a call does, shape_error unless `last` has one entry a branch.
    void run_until(strided_view<Real const, 4> z, Real sigma, std::span<frame_index const> frames,
                   any_processor<Real> processor, std::span<std::optional<site_index> const> last,
                   residuals_type* lent = nullptr) const {
        require_extents("reference_network", "last", std::array{last.size()}, std::array{branches()});
        auto in = frames_of(z, sigma, frames);
        if (lent != nullptr) {
            *lent = residuals_type(frames, z, sigma, branches());
        }
        for (std::uint32_t branch = 0; branch < branches(); ++branch) {
            if (!last[branch]) {
                continue;
            }
            auto pass = pass_of(branch, in, processor);
            pass.last_site = last[branch];
            auto encoded = encode(pass, in);
            if (pass.is_over) {
                continue;
            }
            if (lent != nullptr && is_plain_before_decoder(processor, branch)) {
                lent->put(branch, {encoded, pass.time});
            }
            unet_->decode(pass, std::move(encoded));
        }
    }

    /// Bytes that run_until lends of one frame.
    std::size_t residual_bytes() const { return branches() * encoded_bytes<Real>(config_, latent_grid_); }

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
        require_value(is_finite(conditioning_.guidance_scale), function, "guidance_scale", conditioning_.guidance_scale,
                      "a finite number");
        require_value(conditioning_.guidance_rescale >= 0 && conditioning_.guidance_rescale <= 1, function,
                      "guidance_rescale", conditioning_.guidance_rescale, "a number in [0, 1]");
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

    /// The frames of a call as both branches take them.
    struct stack_of_frames {
        std::span<frame_index const> frames;
        feature_maps<Real> scaled; ///< c_in z
        Real t;                    ///< time of the training
        std::optional<typename embedded_hints<Real>::of_call>
            hints{}; ///< looked up by the first branch that needs them
    };

    stack_of_frames frames_of(strided_view<Real const, 4> z, Real sigma, std::span<frame_index const> frames) const {
        auto const function = "reference_network";
        require_shape(function, "z", z, {frames.size(), config_.in_channels, latent_grid_.height, latent_grid_.width});
        for (auto const frame : frames) {
            require_value(frame.value < hints_.frame_count(), function, "frames", frame.value,
                          ("below " + std::to_string(hints_.frame_count())).c_str());
        }
        auto const c_in = scalings_of(config_.prediction_type, sigma).c_in;
        feature_maps<Real> scaled(frames.size(), latent_grid_, config_.in_channels);
        loop_(frames.size(), [&](std::size_t i) { copy_scaled(scaled.channels_first()[i], z[i], c_in); });
        return {frames, std::move(scaled), time_of(sigma)};
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

    forward_pass<Real> pass_of(std::uint32_t branch, stack_of_frames const& in, any_processor<Real> processor) const {
        auto const is_empty = branch == 0 && branches() == 2;
        auto const& prompt = is_empty ? conditioning_.empty_prompt : conditioning_.prompt;
        return {in.frames, branch, prompt.view(), processor, loop_};
    }

    /// The way down of both networks.
    encoded_maps<Real> encode(forward_pass<Real>& pass, stack_of_frames& in) const {
        if (!in.hints) {
            in.hints = hints_.at(in.frames, loop_);
        }
        auto control = (*control_)(pass, in.scaled, in.t, in.hints->hints, conditioning_.conditioning_scale);
        if (pass.is_over) {
            return control;
        }
        return unet_->encode(pass, in.scaled, in.t, &control);
    }

    /// Whether a processor leaves everything before the decoder as it is.
    bool is_plain_before_decoder(any_processor<Real> const& processor, std::uint32_t branch) const {
        for (std::uint32_t site = 0; site < sites_.size(); ++site) {
            auto const is_before =
                sites_[site].network == network_kind::control || sites_[site].part != network_part::decoder;
            if (is_before && !processor.is_plain_at({{site}, branch})) {
                return false;
            }
        }
        return true;
    }

    unet_config config_;
    network_conditioning<Real> conditioning_;
    any_loop loop_;
    discrete_noise_schedule schedule_;
    grid_extents latent_grid_;
    std::vector<attention_site> sites_;
    std::shared_ptr<controlnet<Real> const> control_;
    std::shared_ptr<unet<Real> const> unet_;
    embedded_hints<Real> hints_;
};

} // namespace genrender::reference

namespace genrender {

/// The front door of the component lies beside the library's own; its parts stay in namespace reference.
using reference::reference_network;

} // namespace genrender

#include <genrender/core/end_header.inl>
