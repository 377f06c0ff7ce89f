// SPDX-License-Identifier: MIT
// [GR eq. 1] Attention over a frame's own tokens and those of keyframes, beside Eigen's product of the same size.
#include <genrender/attention/scaled_dot_product.hpp>

#include <benchmark/benchmark.h>

#include <vector>

using namespace genrender;

namespace {

/// 2 products of multiply and add: Q K^T and P V.
double flops(std::size_t tokens, std::size_t sources, std::size_t channels) {
    return 4.0 * static_cast<double>(tokens) * static_cast<double>(sources) * static_cast<double>(channels);
}

void attention(benchmark::State& state) {
    auto const tokens = static_cast<std::size_t>(state.range(0));
    auto const heads = static_cast<std::size_t>(state.range(1));
    auto const channels = heads * static_cast<std::size_t>(state.range(2));
    auto const blocks = static_cast<std::size_t>(state.range(3)) + 1;
    stack<float, 2> F({tokens, channels});
    stack<float, 2> const Q({tokens, channels});
    stack<float, 3> const K({blocks, tokens, channels});
    stack<float, 3> const V({blocks, tokens, channels});
    std::vector<key_value_view<float>> sources;
    for (std::size_t b = 0; b < blocks; ++b) {
        sources.push_back({K.view()[b], V.view()[b]});
    }
    for (auto _ : state) {
        scaled_dot_product(F.view(), Q, sources, heads);
        benchmark::DoNotOptimize(F.data());
        benchmark::ClobberMemory();
    }
    state.counters["FLOP/s"] =
        benchmark::Counter(flops(tokens, blocks * tokens, channels), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(attention)
    ->ArgNames({"tokens", "heads", "head_size", "keyframes"})
    ->Args({1024, 8, 80, 0})
    ->Args({1024, 8, 80, 5})
    ->Args({256, 8, 160, 5})
    ->Unit(benchmark::kMillisecond);

void matrix_product(benchmark::State& state) {
    auto const n = static_cast<Eigen::Index>(state.range(0));
    auto const k = static_cast<Eigen::Index>(state.range(1));
    matrix<float> const A = matrix<float>::Random(n, k);
    matrix<float> const B = matrix<float>::Random(n, k);
    matrix<float> C(n, n);
    for (auto _ : state) {
        C.noalias() = A * B.transpose();
        benchmark::DoNotOptimize(C.data());
        benchmark::ClobberMemory();
    }
    state.counters["FLOP/s"] =
        benchmark::Counter(2.0 * static_cast<double>(n * n * k), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(matrix_product)->ArgNames({"tokens", "head_size"})->Args({1024, 80})->Args({256, 160});

} // namespace
