// SPDX-License-Identifier: MIT
// A network of LibTorch as a denoiser: it calls back at its self-attention modules, of which it need not tell beforehand.
#pragma once

#include "../comparison.hpp"

#include <genrender/adapters/torch.hpp>
#include <genrender/sampling/denoiser.hpp>
#include <genrender/sampling/noise_schedule.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <ATen/Functions.h>

#include <array>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

using namespace genrender::adapters;

// docs:begin libtorch_sites
/// Gives F [frames, tokens, channels] of a self-attention module, by its name, its input f, W^Q, W^K, W^V and its heads.
using self_attention = std::function<at::Tensor(std::string const& module, at::Tensor const& f, at::Tensor const& Q,
                                                at::Tensor const& K, at::Tensor const& V, std::int64_t heads)>;
/// The network's output for c_in z at time t, a prompt [1, words, channels] and the hints of the frames of z.
using torch_network = std::function<at::Tensor(at::Tensor const& z, double t, at::Tensor const& prompt,
                                               at::Tensor const& hints, self_attention const& run)>;

/// The self-attention modules of a network, found by running it once.
struct torch_sites {
    std::vector<attention_site> sites;
    std::map<std::string, std::pair<site_index, torch_module>> modules;

    torch_sites(torch_network const& network, at::Tensor const& z, at::Tensor const& prompt, at::Tensor const& hints) {
        c10::InferenceMode const no_gradients;
        auto const find = [&](auto const& name, auto const& f, auto const& Q, auto const& K, auto const& V,
                              auto heads) {
            using enum network_part;
            auto const part = name[0] == 'u' ? decoder : name[0] == 'd' ? encoder : middle;
            grid_extents grid{static_cast<std::size_t>(z.size(2)), static_cast<std::size_t>(z.size(3))};
            while (grid.size() > static_cast<std::size_t>(f.size(1))) {
                grid = {grid.height / 2, grid.width / 2};
            }
            modules[name] = {{static_cast<std::uint32_t>(sites.size())}, torch_module::of_matrices(Q, K, V, heads)};
            sites.push_back({name, network_kind::denoising, part, grid, static_cast<std::size_t>(f.size(2))});
            return f;
        };
        network(z, 0, prompt, hints, find);
    }
};
// docs:end

// docs:begin libtorch_denoiser
struct torch_denoiser {
    using real_type = float;
    using features_type = at::Tensor;
    torch_network network;
    at::Tensor hints;                  // of every frame, on the network's device
    std::array<at::Tensor, 2> prompts; // the negative one first
    float guidance;
    prediction predicted;
    grid_extents grid;
    std::int64_t channels;
    discrete_noise_schedule schedule;
    torch_sites found{
        network,
        at::zeros({1, channels, static_cast<std::int64_t>(grid.height), static_cast<std::int64_t>(grid.width)},
                  hints.options()),
        prompts[0], hints.slice(0, 0, 1)};
    torch_plans plans{};

    std::size_t latent_channels() const { return static_cast<std::size_t>(channels); }
    grid_extents latent_grid() const { return grid; }
    std::span<attention_site const> sites() const { return found.sites; }
    std::size_t branches() const { return prompts.size(); }

    template <attention_processor<torch_attention_call> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        c10::InferenceMode const no_gradients;
        auto const [c_skip, c_out, c_in] = scalings_of(predicted, sigma);
        auto const noisy = tensor_of(z).to(hints.device());
        std::vector<at::Tensor> hint;
        for (auto const frame : frames) {
            hint.push_back(hints[frame.value]);
        }
        std::array<at::Tensor, 2> outputs;
        for (std::uint32_t branch = 0; branch < outputs.size(); ++branch) {
            auto const run = [&](std::string const& name, at::Tensor const& f, auto const&...) -> at::Tensor {
                auto const& [site, module] = found.modules.at(name);
                torch_attention_call call({site, branch}, frames, f, module, plans);
                return processor(call);
            };
            outputs[branch] = network(c_in * noisy, schedule.t_of(sigma), prompts[branch], at::stack(hint), run);
        }
        auto const guided = outputs[0] + guidance * (outputs[1] - outputs[0]);
        tensor_of(x0).copy_(c_skip * noisy + c_out * guided);
    }
};
// docs:end

/// The device that the environment variable GENRENDER_ENGINE_DEVICE names, else the processor.
inline at::Device chosen_device() {
    auto const* const named = std::getenv("GENRENDER_ENGINE_DEVICE");
    return at::Device(named != nullptr ? named : "cpu");
}

// docs:begin libtorch_conditioning
/// A network as the conditioning of a case has it. `hints` are as the network takes them.
inline torch_denoiser denoiser_of(engine_case const& given, torch_network network, at::Tensor const& hints) {
    auto const& told = given.conditioning;
    auto const& config = given.config;
    auto const rows = [&](auto const& text) { return tensor_of(text.view()).unsqueeze(0).to(hints.device()); };
    return {.network = std::move(network),
            .hints = hints,
            .prompts = {rows(told.empty_prompt), rows(told.prompt)},
            .guidance = told.guidance_scale,
            .predicted = config.prediction_type,
            .grid = {told.hint.extent(2) / config.hint_scale(), told.hint.extent(3) / config.hint_scale()},
            .channels = static_cast<std::int64_t>(config.in_channels),
            .schedule = discrete_noise_schedule(
                scaled_linear_alphas_cumprod(config.beta_start, config.beta_end, config.num_train_timesteps))};
}
// docs:end

} // namespace genrender::examples
