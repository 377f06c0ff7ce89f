// SPDX-License-Identifier: MIT
// [GR eq. 5, 6] One injected module at shapes of Stable Diffusion's decoder, keyframes kept in 16 bits beside the same
// kept as they were computed.
#include <genrender/injection/host_attention_call.hpp>

#include <genrender/core/random.hpp>
#include <genrender/injection/pre_attention.hpp>

#include "benchmarks/support/paired_timing.hpp"

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <vector>

using namespace genrender;
using benchmarks::floor_of;
using benchmarks::time_against;

namespace {

constexpr std::size_t keyframes = 5;

/// Modules of eight heads whose projections nobody asks for here.
struct eight_heads {
    void query(strided_view<float, 2>, strided_view<float const, 2>) const {}
    void key(strided_view<float, 2>, strided_view<float const, 2>) const {}
    void value(strided_view<float, 2>, strided_view<float const, 2>) const {}
    std::size_t heads() const { return 8; }
};

host_features<float> random_features(std::size_t frames, std::size_t tokens, std::size_t channels, std::uint32_t what) {
    auto const features = host_features<float>::allocate({frames, tokens, channels});
    for (std::size_t e = 0; e < features.view().size(); ++e) {
        features.view().data()[e] =
            static_cast<float>(uniform_value(1, random_stream::user, {static_cast<std::uint32_t>(e), what, 0})) - 0.5F;
    }
    return features;
}

/// Attention of one frame to itself and five keyframes; a share above 1 is what 16 bits gain.
void attend(benchmark::State& state) {
    auto const tokens = static_cast<std::size_t>(state.range(0));
    auto const channels = static_cast<std::size_t>(state.range(1));
    auto const storage = static_cast<feature_storage>(state.range(2));
    std::vector<frame_index> const frames(1);
    eight_heads const module;
    auto const Q = random_features(1, tokens, channels, 0);
    auto const K = random_features(1, tokens, channels, 1);
    auto const V = random_features(1, tokens, channels, 2);
    auto const K_KF = random_features(keyframes, tokens, channels, 3);
    auto const V_KF = random_features(keyframes, tokens, channels, 4);
    host_attention_call<float, eight_heads> const call({}, frames, Q, module);
    auto const K_kept = call.stored(K_KF, storage);
    auto const V_kept = call.stored(V_KF, storage);
    auto const run = [&](host_features<float> const& keys, host_features<float> const& values) {
        benchmark::DoNotOptimize(call.attend(Q, {pre_attention_sources(K, V, 0, keys, values, keyframes)}));
    };
    time_against(
        state, floor_of{"keyframes kept as float"}, [&] { run(K_kept, V_kept); }, [&] { run(K_KF, V_KF); });
    state.counters["FLOP"] = 4.0 * static_cast<double>(tokens * tokens * (keyframes + 1) * channels);
}
BENCHMARK(attend)
    ->ArgNames({"tokens", "channels", "storage"})
    ->Args({1024, 640, 1})
    ->Args({1024, 640, 2})
    ->Args({256, 1280, 1})
    ->Args({256, 1280, 2})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

/// Rounding of what a keyframe pass keeps at one module, beside a copy of it.
void store(benchmark::State& state) {
    auto const storage = static_cast<feature_storage>(state.range(0));
    auto const features = random_features(keyframes, 1024, 640, 0);
    time_against(
        state, floor_of{"copy as float"},
        [&] { benchmark::DoNotOptimize(host_features<float>::rounded(features.view(), storage)); },
        [&] { benchmark::DoNotOptimize(host_features<float>::rounded(features.view(), feature_storage::same)); });
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(features.view().size() * 6));
}
BENCHMARK(store)->ArgName("storage")->Arg(1)->Arg(2)->UseManualTime()->Unit(benchmark::kMillisecond);

} // namespace
