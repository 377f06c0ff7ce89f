// SPDX-License-Identifier: MIT
// [GR eq. 6] The kernel of blending at the shapes of Stable Diffusion's decoder, beside a copy of the same bytes.
#include <genrender/blending/mix_rows.hpp>

#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>

#include <benchmark/benchmark.h>

#include <cstring>
#include <vector>

using namespace genrender;

namespace {

constexpr std::size_t keyframes = 5;

/// Every token mixes three of the keyframes' tokens.
struct rows_of_three {
    std::vector<std::uint32_t> offsets{0};
    std::vector<std::uint32_t> sources;
    std::vector<float> weights;

    explicit rows_of_three(std::size_t tokens) {
        for (std::uint32_t t = 0; t < tokens; ++t) {
            for (std::uint32_t e = 0; e < 3; ++e) {
                auto const k = (t / 97 + e) % keyframes;
                auto const near = (t + uniform_below(5, 1, random_stream::test, {t, e, 0})) % tokens;
                sources.push_back(static_cast<std::uint32_t>(k * tokens + near));
                weights.push_back(1.0f / 3);
            }
            offsets.push_back(static_cast<std::uint32_t>(sources.size()));
        }
    }
};

void shapes(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"tokens", "channels"})->Args({4096, 320})->Args({1024, 640})->Args({256, 1280})->Args({64, 1280});
}

void mix(benchmark::State& state) {
    auto const tokens = static_cast<std::size_t>(state.range(0));
    auto const channels = static_cast<std::size_t>(state.range(1));
    stack<float, 2> F({tokens, channels});
    stack<float, 3> const F_KF({keyframes, tokens, channels});
    rows_of_three const plan(tokens);
    for (auto _ : state) {
        mix_rows(F.view(), F_KF, {plan.offsets, plan.sources, plan.weights}, 0.7f);
        benchmark::DoNotOptimize(F.data());
        benchmark::ClobberMemory();
    }
    // Three rows read, F read and written.
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(5 * F.size() * sizeof(float)));
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(tokens));
}
BENCHMARK(mix)->Apply(shapes);

void copy_of_the_same_bytes(benchmark::State& state) {
    auto const size = 5 * static_cast<std::size_t>(state.range(0) * state.range(1)) / 2;
    std::vector<float> from(size, 1);
    std::vector<float> to(size);
    for (auto _ : state) {
        std::memcpy(to.data(), from.data(), size * sizeof(float));
        benchmark::DoNotOptimize(to.data());
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(2 * size * sizeof(float)));
}
BENCHMARK(copy_of_the_same_bytes)->Apply(shapes);

} // namespace
