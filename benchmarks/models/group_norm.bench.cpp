// SPDX-License-Identifier: MIT
// GroupNorm and SiLU of a frame's features beside a copy of them: two readings and a writing against one of each.
#include <genrender/core/stack.hpp>
#include <genrender/models/group_norm.hpp>

#include <benchmarks/support/paired_timing.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

using namespace genrender;

namespace {

void group_norm_silu(benchmark::State& state) {
    auto const size = static_cast<std::size_t>(state.range(0));
    auto const channels = static_cast<std::size_t>(state.range(1));
    grid_extents const grid{size, size};
    auto source = weights<float>::seeded(1, "benchmark");
    group_norm<float> const norm(source, "norm", channels, 8, 1e-5f);
    stack<float, 2> in({grid.size(), channels});
    for (std::size_t i = 0; i < in.size(); ++i) {
        in.data()[i] = static_cast<float>(i * 7919 % 1009) / 504.0f - 1;
    }
    padded_map<float> out(grid, channels);
    padded_map<float> copied(grid, channels);
    benchmarks::time_against(
        state, {"copy of the same bytes"}, [&] { norm.with_silu(out, in); },
        [&] {
            for (std::size_t y = 0; y < size; ++y) {
                std::copy_n(in.data() + y * size * channels, size * channels, copied.row(y));
            }
        });
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(2 * in.size() * sizeof(float)));
}
BENCHMARK(group_norm_silu)
    ->ArgNames({"size", "channels"})
    ->Args({32, 32})
    ->Args({64, 64})
    ->Args({64, 320})
    ->Args({32, 640})
    ->Unit(benchmark::kMicrosecond)
    ->UseManualTime();

} // namespace
