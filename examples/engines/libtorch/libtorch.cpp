// SPDX-License-Identifier: MIT
// A network in ATen behind genrender, by callback, compared with the library's own.
#include "conditioning.hpp"
#include "loading.hpp"

#include <genrender/pipeline/render.hpp>

#include <ATen/Parallel.h>

using namespace genrender;
using namespace genrender::examples;

int main() {
    at::set_num_threads(1);
    auto const device = chosen_device();
    return compare_engine("LibTorch on " + device.str(), "callback", 1e-4, [&](engine_case const& given) {
        // docs:begin libtorch_render
        auto const unet = network_of(given.unet, given.config, device);
        auto const control = network_of(given.controlnet, given.config, device);
        auto const predict = [&](at::Tensor const& z, double t, at::Tensor const& prompt, at::Tensor const& hints,
                                 torch_self_attention const& run) {
            return engine::predict(unet, control, z, t, prompt, hints, run);
        };
        auto const hints = control.embedded_hint(tensor_of(given.conditioning.hint.view()).to(device));
        return render(denoiser_of(given, predict, hints), to_uv_view(given.UV), {.settings = given.settings});
        // docs:end
    });
}
