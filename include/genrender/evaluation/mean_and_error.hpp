// SPDX-License-Identifier: MIT
// A figure of a table: the mean of several runs and how sure it is.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

namespace genrender {

/// Mean of independent runs. For paired runs, that of their differences says whether one method beats another.
struct mean_and_error {
    double mean = 0;             ///< of the runs
    std::optional<double> error; ///< standard error of the mean, s / sqrt(count); none of a single run
    std::size_t count = 0;       ///< number of runs
};

/// Mean and standard error, from the unbiased variance, of `values`. Throws value_error if there are none.
inline mean_and_error mean_and_error_of(std::span<double const> values) {
    require_value(!values.empty(), "mean_and_error_of", "number of values", values.size(), "at least 1");
    auto const n = static_cast<double>(values.size());
    mean_and_error result{0, std::nullopt, values.size()};
    for (auto const value : values) {
        result.mean += value / n;
    }
    if (values.size() > 1) {
        double squares = 0;
        for (auto const value : values) {
            squares += (value - result.mean) * (value - result.mean);
        }
        result.error = std::sqrt(squares / (n - 1) / n);
    }
    return result;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
