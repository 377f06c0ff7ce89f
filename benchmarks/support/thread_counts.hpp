// SPDX-License-Identifier: MIT
// The numbers of threads that a kernel is timed on.
#pragma once

#include <cstdint>
#include <vector>

namespace genrender::benchmarks {

/// 1, 2, 4 ... below `most`, and `most`, which is at least 1.
inline std::vector<std::int64_t> thread_counts(std::int64_t most) {
    std::vector<std::int64_t> counts;
    for (std::int64_t threads = 1; threads < most; threads *= 2) {
        counts.push_back(threads);
    }
    counts.push_back(most);
    return counts;
}

} // namespace genrender::benchmarks
