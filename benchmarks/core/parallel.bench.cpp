// SPDX-License-Identifier: MIT
// What it costs to share a loop: threads that wait in a pool, beside threads made for each loop.
#include <genrender/core/parallel.hpp>

#include <benchmark/benchmark.h>

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "benchmarks/support/on_threads.hpp"
#include "benchmarks/support/paired_timing.hpp"

using namespace genrender;
using benchmarks::floor_of;
using benchmarks::time_against;

namespace {

/// About `nanoseconds` of arithmetic that nobody can leave out.
void work_for(std::size_t nanoseconds) {
    double x = 1;
    for (std::size_t i = 0; i < nanoseconds; ++i) {
        x = x * 1.0000001 + 1e-9;
        benchmark::DoNotOptimize(x);
    }
}

/// The loop of before: threads live as long as one loop.
void spawning_loop(std::size_t threads, std::size_t count, std::size_t nanoseconds) {
    std::atomic<std::size_t> next{0};
    auto const work = [&] {
        for (auto i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
            work_for(nanoseconds);
        }
    };
    std::vector<std::thread> helpers;
    for (std::size_t i = 1; i < threads; ++i) {
        helpers.emplace_back(work);
    }
    work();
    for (auto& helper : helpers) {
        helper.join();
    }
}

/// A loop of short bodies on the pool, against threads made anew: a share above 1 is the pool's gain.
void shared_loop(benchmark::State& state) {
    auto const threads = static_cast<std::size_t>(state.range(0));
    auto const nanoseconds = static_cast<std::size_t>(state.range(1));
    constexpr std::size_t count = 8;
    threaded_loop const loop(threads);
    time_against(
        state, floor_of{"threads made for each loop"},
        [&] { loop(count, [&](std::size_t) { work_for(nanoseconds); }); },
        [&] { spawning_loop(threads, count, nanoseconds); });
}
BENCHMARK(shared_loop)
    ->ArgNames({"threads", "ns_each"})
    ->Args({2, 1})
    ->Args({2, 1000})
    ->Args({2, 10000})
    ->Args({2, 100000})
    ->UseManualTime();

/// Arithmetic alone on so many threads: what the machine's threads are worth, whatever the library does. A share of the
/// number of threads is all there is.
void arithmetic(benchmark::State& state) {
    benchmarks::time_on_threads(state,
                                [](threaded_loop const& loop) { loop(12, [](std::size_t) { work_for(2000000); }); });
}
BENCHMARK(arithmetic)->Apply(benchmarks::on_thread_counts);

} // namespace
