// SPDX-License-Identifier: MIT
// A network in ATen behind genrender, by callback, compared with the library's own.
#include "denoiser.hpp"
#include "network.hpp"

#include <genrender/pipeline/render.hpp>

#include <ATen/Parallel.h>

using namespace genrender;
using namespace genrender::examples;

// docs:begin libtorch_network
/// The network of a file's tensors.
static engine::network network_of(named_tensors const& file, reference::unet_config const& config, at::Device device) {
    auto const& heads = config.attention_head_dim;
    engine::network network{{}, {heads.begin(), heads.end()}, static_cast<std::int64_t>(config.norm_num_groups)};
    for (auto const& [name, tensor] : file) {
        std::vector<std::int64_t> const shape(tensor.shape.begin(), tensor.shape.end());
        auto const all = tensor_of(strided_view<float const, 1>(tensor.values.data(), {tensor.values.size()}));
        network.tensors[name] = all.view(shape).to(device, at::kFloat, false, true);
    }
    return network;
}
// docs:end

int main() {
    at::set_num_threads(1);
    auto const device = chosen_device();
    return compare_engine("LibTorch on " + device.str(), "callback", 1e-4, [&](engine_case const& given) {
        // docs:begin libtorch_render
        auto const unet = network_of(given.unet, given.config, device);
        auto const control = network_of(given.controlnet, given.config, device);
        auto const predict = [&](at::Tensor const& z, double t, at::Tensor const& prompt, at::Tensor const& hints,
                                 self_attention const& run) {
            return engine::predict(unet, control, z, t, prompt, hints, run);
        };
        auto const hints = control.embedded_hint(tensor_of(given.conditioning.hint.view()).to(device));
        return render(denoiser_of(given, predict, hints), to_uv_view(given.UV), {.settings = given.settings});
        // docs:end
    });
}
