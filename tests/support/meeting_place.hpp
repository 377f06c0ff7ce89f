// SPDX-License-Identifier: MIT
// Shows how many threads are at a place at the same time.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>

namespace genrender::testing {

/// A place where a thread waits until others have come, or for so long.
class meeting_place {
public:
    /// Stays until two threads have been here at the same time, now or before, or for as long as `patience`.
    void meet(std::chrono::milliseconds patience) {
        std::unique_lock lock(mutex_);
        most_ = std::max(most_, ++here_);
        came_.notify_all();
        came_.wait_for(lock, patience, [&] { return most_ >= 2; });
        --here_;
    }

    /// The most threads that were here at the same time.
    std::size_t most() const { return most_; }

private:
    std::mutex mutex_;
    std::condition_variable came_;
    std::size_t here_ = 0;
    std::size_t most_ = 0;
};

} // namespace genrender::testing
