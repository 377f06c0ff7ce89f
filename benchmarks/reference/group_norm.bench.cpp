// SPDX-License-Identifier: MIT
// GroupNorm and SiLU of a frame's features beside a copy of them, two readings and a writing against one of each, and
// beside the numbers that it must make.
#include <genrender/core/stack.hpp>
#include <genrender/reference/group_norm.hpp>

#include <benchmarks/support/native_floors.hpp>
#include <benchmarks/support/paired_timing.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

using namespace genrender;

using namespace genrender::reference;

namespace {

/// `floor(copied, in)` is what is timed in turn.
template <class Floor>
void group_norm_silu_against(benchmark::State& state, benchmarks::floor_of const& floor_is, Floor const& floor) {
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
        state, floor_is, [&] { norm.with_silu(out, in); }, [&] { floor(copied, in); });
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(2 * in.size() * sizeof(float)));
}
void group_norm_silu(benchmark::State& state) {
    group_norm_silu_against(state, {"copy of the same bytes"},
                            [](padded_map<float>& copied, stack<float, 2> const& in) {
                                auto const row = copied.grid().width * copied.channels();
                                for (std::size_t y = 0; y < copied.grid().height; ++y) {
                                    std::copy_n(in.data() + y * row, row, copied.row(y));
                                }
                            });
}

/// What no order of the work can do without: to read everything before anything can be written, and then the SiLU.
void group_norm_silu_of_numbers(benchmark::State& state) {
    group_norm_silu_against(state, {"a reading and the SiLU of each number by Eigen"},
                            [](padded_map<float>& made, stack<float, 2> const& in) {
                                benchmarks::native_silu(made.row(0), in.data(), in.size());
                            });
}

void shapes(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"size", "channels"})
        ->Args({32, 32})
        ->Args({64, 64})
        ->Args({64, 320})
        ->Args({32, 640})
        ->Unit(benchmark::kMicrosecond)
        ->UseManualTime();
}
BENCHMARK(group_norm_silu)->Apply(shapes);
BENCHMARK(group_norm_silu_of_numbers)->Apply(shapes);

} // namespace
