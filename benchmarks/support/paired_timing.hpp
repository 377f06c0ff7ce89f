// SPDX-License-Identifier: MIT
// A kernel and its floor timed in turn, so that a machine that slows down slows both: the share is a median of ratios.
#pragma once

#include <benchmarks/support/median.hpp>

#include <benchmark/benchmark.h>

#include <chrono>
#include <utility>
#include <vector>

namespace genrender::benchmarks {

/// What the least that a kernel must do costs on this machine: a copy of its bytes, a matrix product of its FLOPs.
struct floor_of {
    char const* what; ///< say "copy of the same bytes", shown in the table
    double share = 1; ///< of the kernel's work that one run of the floor does
};

/// Seconds that `body` takes by the clock on the wall.
template <class Body>
double seconds_of(Body&& body) {
    auto const start = std::chrono::steady_clock::now();
    body();
    benchmark::ClobberMemory();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Times `kernel` and `floor` in turn until Google Benchmark has enough, and reports the kernel's time,
/// `share_of_floor` (the median over the floor's turns of its time for the kernel's whole work over the median time of
/// the kernels until its next turn: 1 is as fast as the floor) and the floor's name as label. A floor that takes longer
/// than the kernel takes its turn only now and then, so that it has half of the time and not all of it. The benchmark
/// must be registered with UseManualTime().
template <class Kernel, class Floor>
void time_against(benchmark::State& state, floor_of const& floor_is, Kernel&& kernel, Floor&& floor) {
    std::vector<double> ratios;
    std::vector<double> kernels; // since the floor's last turn
    double kernel_sum = 0;
    double floor_sum = 0;
    double floor_seconds = 0;
    auto const end_turn = [&] {
        if (!kernels.empty()) {
            ratios.push_back(floor_seconds / floor_is.share / median(std::exchange(kernels, {})));
        }
    };
    for (auto _ : state) {
        if (floor_sum <= kernel_sum) {
            end_turn();
            floor_seconds = seconds_of(floor);
            floor_sum += floor_seconds;
        }
        kernels.push_back(seconds_of(kernel));
        kernel_sum += kernels.back();
        state.SetIterationTime(kernels.back());
    }
    end_turn();
    state.counters["share_of_floor"] = median(std::move(ratios));
    state.SetLabel(floor_is.what);
}

} // namespace genrender::benchmarks
