// SPDX-License-Identifier: MIT
// Stable Diffusion 1.5 in full size with random weights: a text, one step of a frame of 512 x 512 pixels in one guidance branch
// (ControlNet, hint and all, and UNet), and a picture. Its peer is benchmarks/peers/stable_diffusion.py.
#include <genrender/attention/plain_attention.hpp>
#include <genrender/reference/autoencoder_kl.hpp>
#include <genrender/reference/clip_text_encoder.hpp>
#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/unet.hpp>

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

/// Any numbers in [-1, 1].
template <class View>
void fill(View values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        values.data()[i] = static_cast<float>(i * 7919 % 1009) / 504.0f - 1;
    }
}

void stable_diffusion_text(benchmark::State& state) {
    auto source = weights<float>::seeded(1, "text_encoder");
    clip_text_encoder<float> const encode({}, source);
    std::vector<std::uint32_t> const ids(encode.most_tokens(), 320);
    threaded_loop const loop(static_cast<std::size_t>(state.range(0)));
    for (auto _ : state) {
        benchmark::DoNotOptimize(encode(ids, loop).data());
    }
}

void stable_diffusion_step(benchmark::State& state) {
    unet_config const config;
    grid_extents const grid{64, 64};
    site_list sites(grid);
    auto control_source = weights<float>::seeded(1, "controlnet");
    auto unet_source = weights<float>::seeded(1, "unet");
    controlnet<float> const control(config, control_source, sites);
    unet<float> const denoiser(config, unet_source, sites);
    feature_maps<float> z(1, grid, config.in_channels);
    fill(z.view());
    feature_maps<float> hint(1, {512, 512}, config.conditioning_channels);
    fill(hint.view());
    stack<float, 2> prompt({77, config.cross_attention_dim});
    fill(prompt.view());
    std::vector<frame_index> const frames{{0}};
    plain_attention const plain;
    threaded_loop const loop(static_cast<std::size_t>(state.range(0)));
    forward_pass<float> pass{frames, 0, prompt.view(), plain, loop};
    for (auto _ : state) {
        auto const embedded = control.embed(hint);
        auto const added = control(pass, z, 417.0f, std::vector<feature_maps<float> const*>{&embedded});
        auto const out = denoiser(pass, z, 417.0f, &added);
        benchmark::DoNotOptimize(out.view().data());
    }
}

void stable_diffusion_picture(benchmark::State& state) {
    auto source = weights<float>::seeded(1, "vae");
    autoencoder_kl<float> const vae({}, source, autoencoder_parts::decoder);
    stack<float, 3> z({4, 64, 64});
    fill(z.view());
    threaded_loop const loop(static_cast<std::size_t>(state.range(0)));
    for (auto _ : state) {
        benchmark::DoNotOptimize(vae.decode(z, {.loop = loop}).data());
    }
}

BENCHMARK(stable_diffusion_text)
    ->ArgName("threads")
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(stable_diffusion_step)
    ->ArgName("threads")
    ->Arg(2)
    ->Iterations(1)
    ->Repetitions(3)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(stable_diffusion_picture)
    ->ArgName("threads")
    ->Arg(2)
    ->Iterations(1)
    ->Repetitions(3)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

} // namespace
