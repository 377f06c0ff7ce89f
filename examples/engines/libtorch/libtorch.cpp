// SPDX-License-Identifier: MIT
// An engine of LibTorch behind genrender, by callback: what it takes beside the network, compared with the library's own.
#include "../comparison.hpp"
#include "network.hpp"

#include <genrender/adapters/torch.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/sampling/noise_schedule.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <ATen/Parallel.h>
#include <ATen/ops/stack.h>
#include <c10/core/InferenceMode.h>

using namespace genrender;
using namespace genrender::adapters;
using namespace genrender::examples;

// docs:begin libtorch_modules
/// A self-attention module: which site it is, and its matrices.
struct torch_site {
    site_index index;
    torch_module module;
};

/// The sites of a UNet on latents of this grid, and its modules by name.
inline std::map<std::string, torch_site> find_sites(engine::network const& unet, grid_extents grid,
                                                    std::vector<attention_site>& sites) {
    std::map<std::string, torch_site> found;
    for (auto const& [tensor, Q] : unet.tensors) {
        auto const end = tensor.find(".attn1.to_q.weight");
        if (end == std::string::npos) {
            continue;
        }
        auto const name = tensor.substr(0, end) + ".attn1";
        auto const is_up = name.starts_with("up_blocks.");
        auto const is_down = name.starts_with("down_blocks.");
        auto const number = is_up || is_down ? std::stoi(name.substr(name.find('.') + 1)) : 0;
        auto const level = static_cast<std::size_t>(is_down ? number : unet.last_level() - number);
        auto const part = is_up ? network_part::decoder : is_down ? network_part::encoder : network_part::middle;
        found[name] = {
            {static_cast<std::uint32_t>(sites.size())},
            torch_module::of_matrices(Q, unet.weight(name + ".to_k"), unet.weight(name + ".to_v"), unet.heads[level])};
        sites.push_back({name,
                         network_kind::denoising,
                         part,
                         {grid.height >> level, grid.width >> level},
                         static_cast<std::size_t>(Q.size(0))});
    }
    return found;
}
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
    grid_extents grid;
    std::vector<attention_site> modules;
    std::map<std::string, torch_site> sites_by_name = find_sites(unet, grid, modules);
    discrete_noise_schedule schedule{};
    torch_plans plans{};

    std::size_t latent_channels() const { return static_cast<std::size_t>(unet.weight("conv_in").size(1)); }
    grid_extents latent_grid() const { return grid; }
    std::span<attention_site const> sites() const { return modules; }
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
                auto const& site = sites_by_name.at(name);
                torch_attention_call call({site.index, branch}, frames, f, site.module, plans);
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
inline engine::network network_of(std::map<std::string, named_tensor> const& file,
                                  reference::unet_config const& config) {
    engine::network network{{},
                            {config.attention_head_dim.begin(), config.attention_head_dim.end()},
                            static_cast<std::int64_t>(config.norm_num_groups)};
    for (auto const& [name, tensor] : file) {
        std::vector<std::int64_t> const shape(tensor.shape.begin(), tensor.shape.end());
        auto const all = tensor_of(strided_view<float const, 1>(tensor.values.data(), {tensor.values.size()}));
        network.tensors[name] = all.view(shape).clone();
    }
    return network;
}

int main() {
    at::set_num_threads(1);
    return compare_engine("LibTorch", "callback", 1e-4, [](engine_case const& given) -> engine_frames {
        c10::InferenceMode const no_gradients;
        auto const& told = given.conditioning;
        auto const control = network_of(given.controlnet, given.config);
        auto const scale = given.config.hint_scale();
        // docs:begin libtorch_render
        torch_denoiser const phi{network_of(given.unet, given.config),
                                 control,
                                 control.embedded_hint(tensor_of(told.hint.view())),
                                 {tensor_of(told.empty_prompt.view()), tensor_of(told.prompt.view())},
                                 told.guidance_scale,
                                 given.config.prediction_type,
                                 {told.hint.extent(2) / scale, told.hint.extent(3) / scale},
                                 {}};
        auto result = render(phi, to_uv_view(given.UV), {.settings = given.settings});
        // docs:end
        return {std::move(result.z), std::move(result.report)};
    });
}
