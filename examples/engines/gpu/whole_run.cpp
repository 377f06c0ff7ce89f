// SPDX-License-Identifier: MIT
// whole_run PIXELS...: a whole run by `render` on a device, against the same run in plain PyTorch there, of the network in ATen.
// GENRENDER_ENGINE_DEVICE names the device.
#include "../libtorch/conditioning.hpp"
#include "../libtorch/loading.hpp"
#include "../measures.hpp"
#include "plain_run.hpp"

#include <genrender/pipeline/render.hpp>

#include <ATen/Parallel.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>

using namespace genrender;
using namespace genrender::examples;

/// Wall-clock seconds of some work that ends with latents in host memory.
static double wall_seconds_of(auto const& work) {
    auto const start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// One row of the table. Returns whether both runs give the same latents.
static bool compare(std::size_t size, at::Device device) {
    constexpr double bound = 1e-4;
    auto given = case_of_size(size);
    given.settings.frames_per_call = given.conditioning.hint.extent(0);
    given.settings.calls_at_once = 1;
    auto const unet = network_of(given.unet, given.config, device);
    auto const control = network_of(given.controlnet, given.config, device);
    torch_network const network = [&](at::Tensor const& z, double t, at::Tensor const& prompt, at::Tensor const& hints,
                                      torch_self_attention const& run) {
        return engine::predict(unet, control, z, t, prompt, hints, run);
    };
    auto const hints = control.embedded_hint(tensor_of(given.conditioning.hint.view()).to(device));
    auto const phi = denoiser_of(given, network, hints);
    latents<float> z;
    at::Tensor plain;
    auto const ours = [&] { z = render(phi, to_uv_view(given.UV), {.settings = given.settings}).z; };
    auto const theirs = [&] { plain = plain_run(network, conditioning_of(given, hints), given)().cpu(); };
    // A device's first run compiles kernels and takes memory.
    ours();
    theirs();
    auto const ours_seconds = wall_seconds_of(ours);
    auto const plain_seconds = wall_seconds_of(theirs);
    auto expected = latents<float>::from_shape(z.shape());
    tensor_of(to_view(expected)).copy_(plain);
    auto const apart = difference(z, expected);
    std::printf("| %zu px | %.1e | %.2f | %.2f |\n", size, apart, ours_seconds, plain_seconds);
    return apart <= bound;
}

int main(int argc, char** argv) {
    try {
        at::set_num_threads(1);
        auto const device = chosen_device();
        std::printf(
            "A whole run on %s\n\n| pictures | greatest difference | s | s in plain PyTorch |\n|---|---|---|---|\n",
            device.str().c_str());
        bool is_right = argc > 1;
        for (int i = 1; i < argc; ++i) {
            is_right = compare(std::strtoul(argv[i], nullptr, 10), device) && is_right;
        }
        return is_right ? 0 : 1;
    } catch (std::exception const& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
