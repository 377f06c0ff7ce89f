// SPDX-License-Identifier: MIT
// Convolutions of a UNet beside Eigen's product of the same FLOPs, for which neighbourhoods would have to be gathered;
// and on more and more threads beside one.
#include <genrender/core/stack.hpp>
#include <genrender/reference/conv2d.hpp>

#include <benchmarks/support/native_floors.hpp>
#include <benchmarks/support/on_threads.hpp>
#include <benchmarks/support/paired_timing.hpp>

#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>

using namespace genrender;

using namespace genrender::reference;

namespace {

/// Numbers in [-1, 1].
stack<float, 2> numbers(std::array<std::size_t, 2> const& extents) {
    stack<float, 2> values(extents);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values.data()[i] = static_cast<float>(i * 7919 % 1009) / 504.0f - 1;
    }
    return values;
}

void convolution(benchmark::State& state) {
    auto const size = static_cast<std::size_t>(state.range(0));
    auto const ins = static_cast<std::size_t>(state.range(1));
    auto const outs = static_cast<std::size_t>(state.range(2));
    auto const kernel = static_cast<std::size_t>(state.range(3));
    auto const stride = static_cast<std::size_t>(state.range(4));
    grid_extents const grid{size, size};
    auto source = weights<float>::seeded(1, "benchmark");
    conv2d<float> const conv(source, "conv", ins, outs, kernel, stride);
    auto const tokens = conv.out_grid(grid).size();
    auto const inputs = kernel * kernel * ins;
    auto const in = numbers({grid.size(), ins});
    stack<float, 2> out({tokens, outs});

    auto const A = numbers({tokens, inputs});
    auto const B = numbers({inputs, outs});
    stack<float, 2> C({tokens, outs});
    benchmarks::time_against(
        state, {"matrix product of the same FLOPs"}, [&] { conv(out.view(), in, grid); },
        [&] { benchmarks::native_product(C.data(), A.data(), B.data(), tokens, inputs, outs); });
    state.counters["FLOP/s"] = benchmark::Counter(2.0 * static_cast<double>(tokens * inputs * outs),
                                                  benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(convolution)
    ->ArgNames({"size", "in", "out", "kernel", "stride"})
    ->Args({64, 64, 64, 3, 1})
    ->Args({32, 32, 32, 3, 1})
    ->Args({32, 320, 320, 3, 1})
    ->Args({16, 640, 640, 3, 1})
    ->Args({64, 64, 64, 3, 2})
    ->Args({64, 320, 320, 1, 1})
    ->Unit(benchmark::kMicrosecond)
    ->UseManualTime();

/// Tokens are shared out over threads.
void convolution_on_threads(benchmark::State& state) {
    grid_extents const grid{32, 32};
    auto source = weights<float>::seeded(1, "benchmark");
    conv2d<float> const conv(source, "conv", 320, 320);
    auto const in = numbers({grid.size(), 320});
    stack<float, 2> out({grid.size(), 320});
    benchmarks::time_on_threads(state, [&](threaded_loop const& loop) { conv(out.view(), in, grid, loop); });
}
BENCHMARK(convolution_on_threads)->Apply(benchmarks::on_thread_counts);

} // namespace
