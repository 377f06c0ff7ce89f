// SPDX-License-Identifier: MIT
// [GR sec. 3.1] One run of ControlNet and UNet, hint and all: the tiny network as it is shipped, and one shaped like
// Stable Diffusion with a fifth of its channels. Its peer is benchmarks/peers/reference_network.py.
#include <genrender/attention/plain_attention.hpp>
#include <genrender/reference/controlnet.hpp>
#include <genrender/reference/forward_pass.hpp>
#include <genrender/reference/reference_weights.hpp>
#include <genrender/reference/unet.hpp>

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

using namespace genrender;

using namespace genrender::reference;

namespace {

/// All of Stable Diffusion 1.5 but the number of channels.
unet_config mid_config() {
    unet_config config;
    config.in_channels = config.out_channels = 4;
    config.block_out_channels = {64, 128, 256, 256};
    config.level_has_attention = {true, true, true, false};
    config.layers_per_block = 2;
    config.attention_head_dim = {8, 8, 8, 8};
    config.cross_attention_dim = 256;
    config.norm_num_groups = 32;
    config.conditioning_channels = 3;
    config.conditioning_embedding_out_channels = {16, 32, 64, 128};
    config.prediction_type = prediction::epsilon;
    return config;
}

struct networks {
    unet_config config;
    std::unique_ptr<controlnet<float>> control;
    std::unique_ptr<unet<float>> denoiser;

    explicit networks(reference_weights<float> source) : config(source.config) {
        site_list sites({64, 64});
        control = std::make_unique<controlnet<float>>(config, source.controlnet, sites);
        denoiser = std::make_unique<unet<float>>(config, source.unet, sites);
        // For the peer, which runs the same weights: the folder to write them to.
        if (auto const* folder = std::getenv("GENRENDER_NETWORK_FOLDER")) {
            source.save(std::filesystem::path(folder) / std::to_string(config.block_out_channels.front()));
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

void reference_network_tiny(benchmark::State& state) {
    static networks const network(reference_weights<float>::seeded(1));
    run(state, network, 4);
}
BENCHMARK(reference_network_tiny)
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
    static networks const network(reference_weights<float>::seeded(1, mid_config()));
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
