// SPDX-License-Identifier: MIT
// A parallel loop over OpenMP's threads.
#pragma once

#include <genrender/core/begin_header.inl>

#ifndef _OPENMP
#error "genrender/adapters/openmp.hpp: OpenMP is off, expected a compiler that is told to use it (-fopenmp)"
#endif

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>

#include <omp.h>

namespace genrender {

/// A model of parallel_loop that shares indices among OpenMP's threads, so that the library runs on those which the engine
/// has. A loop inside another runs on one thread unless OMP_MAX_ACTIVE_LEVELS, or omp_set_max_active_levels, allows more.
class openmp_loop {
public:
    /// On at most so many threads; 0 leaves it to OpenMP (OMP_NUM_THREADS).
    explicit openmp_loop(int threads = 0) : threads_(threads) {}

    /// Runs body(i) once for every i below `count`. Throws what the first body threw that did; indices not yet begun are
    /// left out then.
    template <class Body>
    void operator()(std::size_t count, Body&& body) const {
        auto const threads = threads_ > 0 ? threads_ : omp_get_max_threads();
        std::exception_ptr error;
        std::atomic<bool> has_failed{false};
#pragma omp parallel for schedule(dynamic) num_threads(threads)
        for (std::int64_t i = 0; i < static_cast<std::int64_t>(count); ++i) {
            if (has_failed.load(std::memory_order_relaxed)) {
                continue; // No exception may leave the region, and none of its iterations either.
            }
            try {
                body(static_cast<std::size_t>(i));
            } catch (...) {
                if (!has_failed.exchange(true)) {
                    error = std::current_exception();
                }
            }
        }
        if (error) {
            std::rethrow_exception(error);
        }
    }

private:
    int threads_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
