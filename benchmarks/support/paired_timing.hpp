// SPDX-License-Identifier: MIT
// A kernel and its floor timed in turn, so that a machine that slows down slows both: the share is a median of ratios.
#pragma once

#include <benchmarks/support/median.hpp>

#include <benchmark/benchmark.h>

#include <chrono>
#include <utility>
#include <vector>

#include <time.h>

namespace genrender::benchmarks {

/// What the least that a kernel must do costs on this machine: a copy of its bytes, a matrix product of its FLOPs.
struct floor_of {
    char const* what; ///< say "copy of the same bytes", shown in the table
    double share = 1; ///< of the kernel's work that one run of the floor does
};

/// The clock on the wall, for everything that may run on several threads.
struct wall_clock {
    static double seconds() {
        return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    }
};

/// The time that the calling thread has been on a processor: what others do on the machine does not count, nor what other
/// threads of the program do.
struct thread_clock {
    static double seconds() {
        timespec time{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    }
};

/// Seconds that `body` takes by a clock.
template <class Clock = wall_clock, class Body>
double seconds_of(Body&& body) {
    auto const start = Clock::seconds();
    body();
    benchmark::ClobberMemory();
    return Clock::seconds() - start;
}

/// Times `kernel` and `floor` in turn until Google Benchmark has enough, and reports the kernel's time,
/// `share_of_floor` (the median over the floor's turns of its time for the kernel's whole work over the median time of
/// the kernels until its next turn: 1 is as fast as the floor) and the floor's name as label. A floor that takes longer
/// than the kernel takes its turn only now and then, so that it has half of the time and not all of it. The benchmark
/// must be registered with UseManualTime().
template <class Clock = wall_clock, class Kernel, class Floor>
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
            floor_seconds = seconds_of<Clock>(floor);
            floor_sum += floor_seconds;
        }
        kernels.push_back(seconds_of<Clock>(kernel));
        kernel_sum += kernels.back();
        state.SetIterationTime(kernels.back());
    }
    end_turn();
    state.counters["share_of_floor"] = median(std::move(ratios));
    state.SetLabel(floor_is.what);
}

} // namespace genrender::benchmarks
