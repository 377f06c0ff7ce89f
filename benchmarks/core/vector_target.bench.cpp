// SPDX-License-Identifier: MIT
// Every hot kernel at each vector target of this machine and at the one that it chooses, each time in turn with the same
// kernel compiled by -march=native, by the time on the processor: a share of 1 is what a program with flags for this
// processor reaches.
#include <genrender/core/vector_target.hpp>

#include <benchmarks/core/hot_kernels.hpp>
#include <benchmarks/core/native_kernels.hpp>
#include <benchmarks/support/paired_timing.hpp>

#include <benchmark/benchmark.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::benchmarks;

namespace {

/// Holds a vector target as long as it lives.
class forced_target {
public:
    explicit forced_target(std::optional<vector_target> target) { force_vector_target(target); }
    forced_target(forced_target const&) = delete;
    forced_target& operator=(forced_target const&) = delete;
    ~forced_target() { force_vector_target(std::nullopt); }
};

void run_at(benchmark::State& state, std::size_t index, std::optional<vector_target> target) {
    forced_target const forced(target);
    auto const& kernel = hot_kernels.at(index);
    auto const run = kernel.make();
    prepare_native_kernel(index);
    // Both have their scratch before anything is timed.
    run();
    run_native_kernel();
    time_against<thread_clock>(state, {"-march=native"}, run, [] { run_native_kernel(); });
    if (kernel.flops > 0) {
        state.counters["FLOP/s"] = benchmark::Counter(kernel.flops, benchmark::Counter::kIsIterationInvariantRate);
    }
}

/// A row `by_target/<kernel>/<target>` each, the chosen one as `chosen`.
bool register_all() {
    std::vector<std::pair<std::string, std::optional<vector_target>>> targets;
    for (auto const target : available_vector_targets()) {
        targets.emplace_back(name_of(target), target);
    }
    targets.emplace_back("chosen", std::nullopt);
    for (std::size_t index = 0; index < hot_kernels.size(); ++index) {
        for (auto const& [name, target] : targets) {
            auto const row = std::string("by_target/") + hot_kernels.at(index).name + "/" + name;
            benchmark::RegisterBenchmark(
                row.c_str(), [index, target = target](benchmark::State& state) { run_at(state, index, target); })
                ->MinTime(0.02)
                ->UseManualTime()
                ->Unit(benchmark::kMicrosecond);
        }
    }
    return true;
}

[[maybe_unused]] bool const is_registered = register_all();

} // namespace
