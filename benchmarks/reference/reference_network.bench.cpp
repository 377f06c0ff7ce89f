// SPDX-License-Identifier: MIT
// [GR sec. 3.1] One run of ControlNet and UNet, hint and all, with random weights: the miniature, and one shaped like
// Stable Diffusion with a fifth of its channels. Its peer is benchmarks/peers/reference_network.py.
#include <genrender/attention/plain_attention.hpp>
#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/diffusers_config.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/safetensors_weights.hpp>
#include <genrender/reference/unet.hpp>

#include <benchmarks/support/miniature_config.hpp>

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

/// All of Stable Diffusion 1.5 but the number of channels.
unet_config mid_config() {
    unet_config config;
    config.block_out_channels = {64, 128, 256, 256};
    config.cross_attention_dim = 256;
    config.conditioning_embedding_out_channels = {16, 32, 64, 128};
    return config;
}

/// Writes a network into a folder in diffusers' layout.
void write_network(std::filesystem::path const& folder, nlohmann::json const& json, weights<float> const& tensors) {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "config.json") << json;
    write_weights((folder / "diffusion_pytorch_model.safetensors").string(), tensors);
}

struct networks {
    unet_config config;
    std::unique_ptr<controlnet<float>> control;
    std::unique_ptr<unet<float>> denoiser;

    explicit networks(unet_config of) : config(std::move(of)) {
        auto control_weights = weights<float>::seeded(1, "controlnet");
        auto unet_weights = weights<float>::seeded(1, "unet");
        site_list sites({64, 64});
        control = std::make_unique<controlnet<float>>(config, control_weights, sites);
        denoiser = std::make_unique<unet<float>>(config, unet_weights, sites);
        // For the peer, which runs the same weights: the folder to write them to.
        if (auto const* folder = std::getenv("GENRENDER_NETWORK_FOLDER")) {
            auto const path = std::filesystem::path(folder) / std::to_string(config.block_out_channels.front());
            write_network(path / "controlnet", controlnet_json(config), control_weights);
            write_network(path / "unet", unet_json(config), unet_weights);
        }
    }
};

/// Any numbers in [-1, 1].
template <class View>
void fill(View values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        values.data()[i] = static_cast<float>(i * 7919 % 1009) / 504.0f - 1;
    }
}

void run(benchmark::State& state, networks const& network, std::size_t prompt_tokens) {
    auto const size = static_cast<std::size_t>(state.range(0));
    auto const count = static_cast<std::size_t>(state.range(1));
    grid_extents const grid{size, size};
    auto const& config = network.config;
    auto const scale = config.hint_scale();

    feature_maps<float> z(count, grid, config.in_channels);
    fill(z.view());
    feature_maps<float> hint(1, {scale * size, scale * size}, config.conditioning_channels);
    fill(hint.view());
    stack<float, 2> prompt({prompt_tokens, config.cross_attention_dim});
    fill(prompt.view());
    std::vector<frame_index> frames(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        frames[i] = frame_index{i};
    }
    plain_attention const plain;
    threaded_loop const loop(static_cast<std::size_t>(state.range(2)));
    forward_pass<float> pass{frames, 0, prompt.view(), plain, loop};
    for (auto _ : state) {
        // Once a run is enough, but the peer has no such memory.
        std::vector<feature_maps<float>> embedded(count);
        std::vector<feature_maps<float> const*> hints(count);
        loop(count, [&](std::size_t i) {
            embedded[i] = network.control->embed(hint);
            hints[i] = &embedded[i];
        });
        auto const added = (*network.control)(pass, z, 417.0f, hints);
        auto const out = (*network.denoiser)(pass, z, 417.0f, &added);
        benchmark::DoNotOptimize(out.view().data());
    }
}

void reference_network_miniature(benchmark::State& state) {
    static networks const network(benchmarks::miniature_config());
    run(state, network, benchmarks::miniature_prompt_tokens);
}
BENCHMARK(reference_network_miniature)
    ->ArgNames({"latents", "frames", "threads"})
    ->Args({32, 1, 1})
    ->Args({64, 1, 1})
    ->Args({32, 8, 1})
    ->Args({32, 1, 2})
    ->Args({64, 1, 2})
    ->Args({32, 8, 2})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

void reference_network_mid(benchmark::State& state) {
    static networks const network(mid_config());
    run(state, network, 77);
}
BENCHMARK(reference_network_mid)
    ->ArgNames({"latents", "frames", "threads"})
    ->Args({32, 1, 1})
    ->Args({64, 1, 1})
    ->Args({32, 2, 1})
    ->Args({32, 1, 2})
    ->Args({64, 1, 2})
    ->Args({32, 2, 2})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

} // namespace
