// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] A network of LibTorch as a denoiser: any function of tensors that calls back at its self-attention modules.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/torch.hpp>
#include <genrender/adapters/torch_latents.hpp>
#include <genrender/adapters/torch_plans.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/sampling/noise_schedule.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <ATen/ops/stack.h>
#include <ATen/ops/zeros.h>
#include <c10/core/InferenceMode.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::adapters {

/// Gives F [frames, tokens, channels] of a self-attention module: by its name, its normed input f [frames, tokens, channels],
/// its matrices W^Q, W^K, W^V [channels, channels] and its number of heads.
using torch_self_attention = std::function<at::Tensor(std::string const& name, at::Tensor const& f, at::Tensor const& Q,
                                                      at::Tensor const& K, at::Tensor const& V, std::int64_t heads)>;

/// A raw network: its output [frames, channels, height, width] for c_in z of the same extents at time t, told the prompt of a
/// guidance branch and the hints of these frames. At its self-attention modules it uses what `run` returns in place of their
/// attention, before or after their matrix `to_out`. It may be called on several threads at once.
using torch_network = std::function<at::Tensor(at::Tensor const& z, double t, at::Tensor const& prompt,
                                               at::Tensor const& hints, torch_self_attention const& run)>;

/// What a network is told beside the latents, all on its device.
struct torch_conditioning {
    at::Tensor hints;                           ///< [frames of the animation, ...], as the network takes them
    std::vector<at::Tensor> prompts;            ///< one, or the negative one and then the other with guidance
    float guidance_scale = 1;                   ///< of classifier-free guidance; unread with one prompt
    prediction predicted = prediction::epsilon; ///< what the network's output stands for
    discrete_noise_schedule schedule{};         ///< the times of its training
};

/// A model of denoiser of any torch_network. Its latents stay on the device of the hints for a whole run (latent_lender), as
/// its features do. Its sites are the modules at which the network calls back, named as diffusers names them: those that begin
/// with `up_blocks.` are the decoder's, with `down_blocks.` the encoder's, all others in the middle.
class torch_denoiser : public torch_latents {
public:
    using real_type = float;                ///< scalar of the latents
    using features_type = at::Tensor;       ///< features on their device
    using call_type = torch_attention_call; ///< what its modules hand over

    /// Of a network for latents of these channels and extents. Runs it once for one frame to find its sites. Throws
    /// value_error for a number of prompts that is neither 1 nor 2, for no hints, if the tokens of a module are not those
    /// of the latents' grid, halved a number of times, or if two modules have one name.
    torch_denoiser(torch_network network, torch_conditioning told, std::size_t channels, grid_extents grid)
        : torch_latents(told.hints.defined() ? told.hints.device() : at::Device(at::kCPU)),
          network_(std::move(network)), told_(std::move(told)), channels_(channels), grid_(grid) {
        constexpr auto here = "torch_denoiser";
        require_value(told_.prompts.size() == 1 || told_.prompts.size() == 2, here, "prompts", told_.prompts.size(),
                      "1, or 2 with classifier-free guidance");
        require_value(told_.hints.dim() > 0 && told_.hints.size(0) > 0, here, "frames of hints",
                      told_.hints.dim() > 0 ? told_.hints.size(0) : 0, "at least 1");
        c10::InferenceMode const no_gradients;
        std::array const extents{std::int64_t{1}, static_cast<std::int64_t>(channels_),
                                 static_cast<std::int64_t>(grid_.height), static_cast<std::int64_t>(grid_.width)};
        network_(at::zeros(extents, told_.hints.options().dtype(at::kFloat)), 0, told_.prompts.front(),
                 told_.hints.slice(0, 0, 1),
                 [this](std::string const& name, at::Tensor const& f, at::Tensor const& Q, at::Tensor const& K,
                        at::Tensor const& V, std::int64_t heads) {
                     add_site(name, f, torch_module::of_matrices(Q, K, V, heads));
                     return f;
                 });
    }

    /// Channels of z.
    std::size_t latent_channels() const { return channels_; }
    /// Height and width of z.
    grid_extents latent_grid() const { return grid_; }
    /// Where the network calls back, in the order in which it does.
    std::span<attention_site const> sites() const { return sites_; }
    /// One a prompt.
    std::size_t branches() const { return told_.prompts.size(); }

    /// D(z, sigma) of latents on the device, of z's extents [frames, channels, height, width]. Throws value_error for a frame
    /// without a hint or a module that was not there when sites were found, shape_error if the network's output has other
    /// extents than z.
    template <attention_processor<torch_attention_call> Processor>
    at::Tensor operator()(at::Tensor const& z, float sigma, std::span<frame_index const> frames,
                          Processor& processor) const {
        c10::InferenceMode const no_gradients;
        auto const [c_skip, c_out, c_in] = scalings_of(told_.predicted, sigma);
        auto const t = told_.predicted == prediction::flow ? 1000.0 * static_cast<double>(flow_time_of(sigma))
                                                           : told_.schedule.t_of(static_cast<double>(sigma));
        auto const hints = hints_of(frames);
        at::Tensor F;
        for (std::uint32_t branch = 0; branch < branches(); ++branch) {
            torch_self_attention const run = [&](std::string const& name, at::Tensor const& f, auto const&...) {
                auto const found = modules_.find(name);
                require_value(found != modules_.end(), "torch_denoiser", "name of a module", name,
                              "one of the modules that the network has had from the beginning");
                torch_attention_call call({found->second.first, branch}, frames, f, found->second.second, plans_);
                return at::Tensor(processor(call));
            };
            auto const output = network_(z.mul(c_in), t, told_.prompts[branch], hints, run).to(at::kFloat);
            require_extents("torch_denoiser", "output of the network", extents_of(output), extents_of(z));
            F = branch == 0 ? output : F.add(output.sub(F), told_.guidance_scale);
        }
        return z.mul(c_skip).add(F, c_out);
    }

    /// The same of views in host memory, both [frames, channels, height, width]: uploaded, estimated, and written into x0.
    template <attention_processor<torch_attention_call> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        download(x0, (*this)(upload(z), sigma, frames, processor));
    }

private:
    static std::vector<std::size_t> extents_of(at::Tensor const& x) { return {x.sizes().begin(), x.sizes().end()}; }

    void add_site(std::string const& name, at::Tensor const& f, torch_module module) {
        using enum network_part;
        auto const part = name.starts_with("up_blocks.")     ? decoder
                          : name.starts_with("down_blocks.") ? encoder
                                                             : middle;
        auto const tokens = static_cast<std::size_t>(f.size(1));
        auto grid = grid_;
        while (grid.size() > tokens && grid.height % 2 == 0 && grid.width % 2 == 0) {
            grid = {grid.height / 2, grid.width / 2};
        }
        require_value(grid.size() == tokens, "torch_denoiser", ("tokens of " + name).c_str(), tokens,
                      "those of the latents' grid, halved a number of times");
        auto const index = site_index{static_cast<std::uint32_t>(sites_.size())};
        require_value(modules_.emplace(name, std::pair(index, std::move(module))).second, "torch_denoiser",
                      "name of a module", name, "one that no other module has");
        sites_.push_back({name, network_kind::denoising, part, grid, static_cast<std::size_t>(f.size(2))});
    }

    at::Tensor hints_of(std::span<frame_index const> frames) const {
        std::vector<at::Tensor> hints;
        for (auto const frame : frames) {
            require_value(frame.value < told_.hints.size(0), "torch_denoiser", "frames", frame.value,
                          ("below " + std::to_string(told_.hints.size(0)) + ", the number of hints").c_str());
            hints.push_back(told_.hints[frame.value]);
        }
        return at::stack(hints);
    }

    torch_network network_;
    torch_conditioning told_;
    std::size_t channels_;
    grid_extents grid_;
    std::vector<attention_site> sites_;
    std::map<std::string, std::pair<site_index, torch_module>> modules_;
    torch_plans plans_;
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
