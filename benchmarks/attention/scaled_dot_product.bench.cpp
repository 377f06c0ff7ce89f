// SPDX-License-Identifier: MIT
// [GR eq. 1] Attention over a frame's own tokens and those of keyframes, beside Eigen's product of as many FLOPs; and on
// more and more threads beside one.
#include <genrender/attention/scaled_dot_product.hpp>

#include <genrender/core/linalg.hpp>
#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>

#include <benchmark/benchmark.h>

#include <benchmarks/support/native_floors.hpp>
#include <benchmarks/support/on_threads.hpp>
#include <benchmarks/support/paired_timing.hpp>

#include <array>
#include <cstdint>
#include <vector>

using namespace genrender;
using namespace genrender::benchmarks;

namespace {

/// Numbers of variance 1, stored as T.
template <class T, std::size_t Rank>
stack<T, Rank> filled(std::array<std::size_t, Rank> const& extents) {
    stack<T, Rank> values(extents);
    for (std::size_t i = 0; i < values.size(); ++i) {
        auto const x = uniform_value(Rank, random_stream::test, {static_cast<std::uint32_t>(i), 0, 0});
        values.data()[i] = static_cast<T>(static_cast<float>(3.4641 * (x - 0.5)));
    }
    return values;
}

/// Tokens of each frame over its own and those of all keyframes, which are stored as T. The floor is a matrix product
/// of 1024^3, as large as Eigen likes them; attention is 4 FLOPs a query, key and channel, and its exponentials are for
/// nothing. Small grids take several frames, so that both sides of the ratio take milliseconds.
template <class T>
void attend(benchmark::State& state) {
    auto const frames = static_cast<std::size_t>(state.range(0));
    auto const tokens = static_cast<std::size_t>(state.range(1));
    auto const heads = static_cast<std::size_t>(state.range(2));
    auto const channels = heads * static_cast<std::size_t>(state.range(3));
    auto const keyframes = static_cast<std::size_t>(state.range(4));
    stack<float, 3> F({frames, tokens, channels});
    auto const Q = filled<float, 3>({frames, tokens, channels});
    auto const K = filled<float, 3>({frames, tokens, channels});
    auto const V = filled<float, 3>({frames, tokens, channels});
    auto const K_KF = filled<T, 3>({keyframes, tokens, channels});
    auto const V_KF = filled<T, 3>({keyframes, tokens, channels});
    std::vector<key_value_view<float>> blocks(keyframes + 1);
    for (std::size_t k = 0; k < keyframes; ++k) {
        blocks[k + 1] = {K_KF.view()[k], V_KF.view()[k]};
    }
    constexpr std::size_t n = 1024;
    static auto const A = filled<float, 2>({n, n});
    static auto const B = filled<float, 2>({n, n});
    static stack<float, 2> C({n, n});

    auto const flops = 4.0 * static_cast<double>(frames * tokens) * static_cast<double>((keyframes + 1) * tokens) *
                       static_cast<double>(channels);
    auto const attend_all = [&] {
        for (std::size_t i = 0; i < frames; ++i) {
            blocks[0] = {K.view()[i], V.view()[i]};
            scaled_dot_product(F.view()[i], Q.view()[i], blocks, heads);
        }
    };
    time_against(state, {"Eigen's matrix product", 2.0 * n * n * n / flops}, attend_all,
                 [&] { native_product(C.data(), A.data(), B.data(), n, n, n); });
    state.counters["FLOP/s"] = benchmark::Counter(flops, benchmark::Counter::kIsIterationInvariantRate);
}

void attention(benchmark::State& state) { attend<float>(state); }
void attention_float16(benchmark::State& state) { attend<float16>(state); }
void attention_bfloat16(benchmark::State& state) { attend<bfloat16>(state); }

// The grids of Stable Diffusion 1.5 at 512 x 512; one head of the largest, for time.
BENCHMARK(attention)
    ->ArgNames({"frames", "tokens", "heads", "head_size", "keyframes"})
    ->ArgsProduct({{1}, {4096}, {1}, {40}, {0, 5, 8}})
    ->ArgsProduct({{1}, {1024}, {8}, {80}, {0, 5, 8}})
    ->ArgsProduct({{4}, {256}, {8}, {160}, {0, 5, 8}})
    ->ArgsProduct({{16}, {64}, {8}, {160}, {0, 5, 8}})
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK(attention_float16)
    ->ArgNames({"frames", "tokens", "heads", "head_size", "keyframes"})
    ->Args({1, 1024, 8, 80, 5})
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK(attention_bfloat16)
    ->ArgNames({"frames", "tokens", "heads", "head_size", "keyframes"})
    ->Args({1, 1024, 8, 80, 5})
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();

/// A frame's own tokens and as many of a keyframe; threads share out heads and queries.
void attention_on_threads(benchmark::State& state) {
    constexpr std::size_t tokens = 1024;
    constexpr std::size_t channels = 640;
    stack<float, 2> F({tokens, channels});
    auto const Q = filled<float, 2>({tokens, channels});
    auto const K = filled<float, 3>({2, tokens, channels});
    auto const V = filled<float, 3>({2, tokens, channels});
    std::array<key_value_view<float>, 2> const blocks{{{K.view()[0], V.view()[0], {}}, {K.view()[1], V.view()[1], {}}}};
    time_on_threads(state, [&](threaded_loop const& loop) { scaled_dot_product(F.view(), Q, blocks, 8, loop); });
}
BENCHMARK(attention_on_threads)->Apply(on_thread_counts);

} // namespace
