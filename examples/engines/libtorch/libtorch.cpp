// SPDX-License-Identifier: MIT
// An engine of LibTorch behind genrender, by callback: what it takes beside the network, compared with the library's own.
#include "../comparison.hpp"
#include "network.hpp"

#include <genrender/adapters/torch.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/sampling/noise_schedule.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <ATen/Parallel.h>

#include <cstdlib>

using namespace genrender;
using namespace genrender::adapters;
using namespace genrender::examples;

// docs:begin libtorch_sites
/// The self-attention modules of a UNet on latents of this grid: each one's site, and its matrices.
struct torch_sites {
    std::vector<attention_site> sites;
    std::map<std::string, std::pair<site_index, torch_module>> by_name;

    torch_sites(engine::network const& unet, grid_extents grid) {
        using enum network_part;
        for (auto const& [tensor, Q] : unet.tensors) {
            if (auto const end = tensor.find(".attn1.to_q.weight"); end != std::string::npos) {
                auto const name = tensor.substr(0, end) + ".attn1";
                auto const part = name[0] == 'u' ? decoder : name[0] == 'd' ? encoder : middle;
                auto const level = unet.level_of(name);
                site_index const index{static_cast<std::uint32_t>(sites.size())};
                by_name[name] = {index, torch_module::of_matrices(Q, unet.weight(name + ".to_k"),
                                                                  unet.weight(name + ".to_v"), unet.heads_of(name))};
                auto const channels = static_cast<std::size_t>(Q.size(0));
                sites.push_back(
                    {name, network_kind::denoising, part, {grid.height >> level, grid.width >> level}, channels});
            }
        }
    }
};
// docs:end

// docs:begin libtorch_denoiser
struct torch_denoiser {
    using real_type = float;
    using features_type = at::Tensor;
    engine::network unet;
    engine::network control;
    at::Tensor hints; // [frames, channels, height, width], embedded
    std::array<at::Tensor, 2> prompts;
    float guidance;
    prediction predicted;
    grid_extents grid{static_cast<std::size_t>(hints.size(2)), static_cast<std::size_t>(hints.size(3))};
    torch_sites modules{unet, grid};
    discrete_noise_schedule schedule{};
    torch_plans plans{};

    std::size_t latent_channels() const { return static_cast<std::size_t>(unet.weight("conv_in").size(1)); }
    grid_extents latent_grid() const { return grid; }
    std::span<attention_site const> sites() const { return modules.sites; }
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
            auto const run = [&](std::string const& name, at::Tensor const& f) -> at::Tensor {
                auto const& [index, module] = modules.by_name.at(name);
                torch_attention_call call({index, branch}, frames, f, module, plans);
                return processor(call);
            };
            outputs[branch] = engine::predict(unet, control, c_in * noisy, schedule.t_of(sigma), prompts[branch],
                                              at::stack(hint), run);
        }
        auto const guided = outputs[0] + guidance * (outputs[1] - outputs[0]);
        tensor_of(x0).copy_(c_skip * noisy + c_out * guided);
    }
};
// docs:end

/// The network of a folder's tensors.
inline engine::network network_of(named_tensors const& file, reference::unet_config const& config, at::Device device) {
    auto const& heads = config.attention_head_dim;
    engine::network network{{}, {heads.begin(), heads.end()}, static_cast<std::int64_t>(config.norm_num_groups)};
    for (auto const& [name, tensor] : file) {
        std::vector<std::int64_t> const shape(tensor.shape.begin(), tensor.shape.end());
        auto const all = tensor_of(strided_view<float const, 1>(tensor.values.data(), {tensor.values.size()}));
        network.tensors[name] = all.view(shape).to(device, at::kFloat, false, true);
    }
    return network;
}

int main() {
    at::set_num_threads(1);
    auto const* const named = std::getenv("GENRENDER_ENGINE_DEVICE");
    at::Device const device(named != nullptr ? named : "cpu");
    return compare_engine("LibTorch on " + device.str(), "callback", 1e-4, [&](engine_case const& given) {
        auto const& told = given.conditioning;
        auto const control = network_of(given.controlnet, given.config, device);
        // docs:begin libtorch_render
        torch_denoiser const phi{
            network_of(given.unet, given.config, device),
            control,
            control.embedded_hint(tensor_of(told.hint.view()).to(device)),
            {tensor_of(told.empty_prompt.view()).to(device), tensor_of(told.prompt.view()).to(device)},
            told.guidance_scale,
            given.config.prediction_type};
        return render(phi, to_uv_view(given.UV), {.settings = given.settings});
        // docs:end
    });
}
