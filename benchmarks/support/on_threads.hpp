// SPDX-License-Identifier: MIT
// A kernel that takes a loop, on 1, 2, 4 ... threads up to the machine's, each time in turn with itself on one.
#pragma once

#include <benchmarks/support/paired_timing.hpp>
#include <benchmarks/support/thread_counts.hpp>

#include <genrender/core/parallel.hpp>

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>

namespace genrender::benchmarks {

/// The numbers of threads of a benchmark as its argument `threads`.
inline void on_thread_counts(benchmark::internal::Benchmark* bench) {
    bench->ArgName("threads")->UseManualTime()->Unit(benchmark::kMillisecond);
    for (auto const threads : thread_counts(static_cast<std::int64_t>(threaded_loop().threads()))) {
        bench->Arg(threads);
    }
}

/// Times `kernel(loop)` on as many threads as the benchmark's argument says; its share is the speed-up beside one.
template <class Kernel>
void time_on_threads(benchmark::State& state, Kernel const& kernel) {
    threaded_loop const many(static_cast<std::size_t>(state.range(0)));
    threaded_loop const one(1);
    time_against(
        state, {"one thread"}, [&] { kernel(many); }, [&] { kernel(one); });
}

} // namespace genrender::benchmarks
