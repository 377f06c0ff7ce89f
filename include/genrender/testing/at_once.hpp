// SPDX-License-Identifier: MIT
// Runs what laws say may run at the same time, at the same time.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>

namespace genrender::testing {

/// Calls `body(i)` once for each `i < count`, from the last to the first, shared out among at most `threads` threads.
/// Bodies may be short, so threads wait for each other, for a second at most, before their first: else one might be
/// done with all before the next begins. The first exception of a body reaches the caller.
template <class Body>
void at_once(std::size_t threads, std::size_t count, Body const& body) {
    auto const used = std::max<std::size_t>(1, std::min(threads, count));
    std::atomic<std::size_t> begun{0};
    threaded_loop{used}(used, [&](std::size_t thread) {
        ++begun;
        auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
        while (begun < used && std::chrono::steady_clock::now() < end) {
        }
        for (auto n = thread; n < count; n += used) {
            body(count - 1 - n);
        }
    });
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
