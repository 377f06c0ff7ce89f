// SPDX-License-Identifier: MIT
// The value in the middle, which one slow moment of the machine does not move.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace genrender::benchmarks {

/// The value in the middle; of an even number the upper of both. `values` must not be empty.
inline double median(std::vector<double> values) {
    auto const middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace genrender::benchmarks
