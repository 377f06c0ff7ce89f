// SPDX-License-Identifier: MIT
// The value in the middle and how far the others lie from it, which one slow moment of the machine does not move.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace genrender::benchmarks {

/// The value in the middle; of an even number the upper of both. `values` must not be empty.
inline double median(std::vector<double> values) {
    auto const middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The median absolute deviation: how far the value in the middle of all is from their median. `values` must not be
/// empty.
inline double median_deviation(std::vector<double> values) {
    auto const middle = median(values);
    for (auto& value : values) {
        value = std::abs(value - middle);
    }
    return median(std::move(values));
}

} // namespace genrender::benchmarks
