// SPDX-License-Identifier: MIT
// Convolutions of a UNet beside Eigen's product of the same FLOPs, for which neighbourhoods would have to be gathered.
#include <genrender/core/linalg.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/reference/conv2d.hpp>

#include <benchmarks/support/paired_timing.hpp>

#include <benchmark/benchmark.h>

#include <cstddef>

using namespace genrender;

using namespace genrender::reference;

namespace {

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
    matrix<float> const in =
        matrix<float>::Random(static_cast<Eigen::Index>(grid.size()), static_cast<Eigen::Index>(ins));
    stack<float, 2> out({tokens, outs});

    matrix<float> const A = matrix<float>::Random(static_cast<Eigen::Index>(tokens), static_cast<Eigen::Index>(inputs));
    matrix<float> const B = matrix<float>::Random(static_cast<Eigen::Index>(inputs), static_cast<Eigen::Index>(outs));
    matrix<float> C(A.rows(), B.cols());
    benchmarks::time_against(
        state, {"matrix product of the same FLOPs"}, [&] { conv(out.view(), in, grid); }, [&] { C.noalias() = A * B; });
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

} // namespace
