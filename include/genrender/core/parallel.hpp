// SPDX-License-Identifier: MIT
// The parallel loop: the one customisation point through which the library uses more than one thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace genrender {

/// Runs `body(i)` once for every i in [0, count), in any order, possibly at once, and returns when all are done.
///
/// expression            | type | meaning
/// ----------------------|------|----------------------------------------------------------------------
/// `loop(count, body)`   | any  | calls `body(i)` once for each `i < count`
///
/// These the compiler cannot check, and a model owes them: every index is visited exactly once; nothing runs after the
/// return; an exception of the body reaches the caller (the first one; indices not yet begun may then be left out).
/// Results of the library do not depend on the model or on its number of threads.
template <class Loop>
concept parallel_loop = requires(Loop const& loop, std::size_t count, void (*body)(std::size_t)) {
    loop(count, body);
};

/// The loop on the caller's thread, in order.
struct sequential_loop {
    template <class Body>
    void operator()(std::size_t count, Body&& body) const {
        for (std::size_t i = 0; i < count; ++i) {
            body(i);
        }
    }
};

/// The loop on `threads` threads, the caller's among them; indices are handed out one at a time, in order. Threads live
/// as long as one loop: the work inside the library's loops is milliseconds and more.
class threaded_loop {
public:
    /// 0 means as many threads as the machine has.
    explicit threaded_loop(std::size_t threads = 0)
        : threads_(threads > 0 ? threads : std::max<std::size_t>(1, std::thread::hardware_concurrency())) {}

    std::size_t threads() const { return threads_; }

    template <class Body>
    void operator()(std::size_t count, Body&& body) const {
        auto const workers = std::min(threads_, count);
        if (workers <= 1) {
            sequential_loop{}(count, body);
            return;
        }
        std::atomic<std::size_t> next{0};
        std::exception_ptr failure;
        std::mutex failure_mutex;
        auto const work = [&] {
            for (auto i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
                try {
                    body(i);
                } catch (...) {
                    std::lock_guard const lock(failure_mutex);
                    if (!failure) {
                        failure = std::current_exception();
                    }
                    next.store(count);
                }
            }
        };
        std::vector<std::thread> helpers;
        helpers.reserve(workers - 1);
        try {
            for (std::size_t i = 1; i < workers; ++i) {
                helpers.emplace_back(work);
            }
        } catch (...) {
            // A machine out of threads is slower, not wrong: those that started share the indices.
        }
        work();
        for (auto& helper : helpers) {
            helper.join();
        }
        if (failure) {
            std::rethrow_exception(failure);
        }
    }

private:
    std::size_t threads_;
};

} // namespace genrender
