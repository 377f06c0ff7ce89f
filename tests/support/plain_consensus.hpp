// SPDX-License-Identifier: MIT
// The consensus of clean estimates written down plainly: every average from a list of values and weights, deviations from
// their definitions.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace genrender::testing {

/// What one cell averages in one channel: values and weights that sum to 1; empty where nothing covers it.
using weighted_values = std::vector<std::pair<double, double>>;

/// The cells of one channel of one frame moved by `strength` (one a cell) towards the consensus of `sources` (one list a
/// cell), with at most `most_gain` of the deviation that averaging took.
inline std::vector<double> plain_consensus(std::vector<double> const& own, std::vector<weighted_values> const& sources,
                                           std::vector<double> const& strength, double most_gain) {
    std::vector<double> averages(own.size());
    double mu = 0;
    double n = 0;
    for (std::size_t t = 0; t < own.size(); ++t) {
        for (auto const& [value, weight] : sources[t]) {
            averages[t] += weight * value;
        }
        if (!sources[t].empty()) {
            mu += averages[t];
            n += 1;
        }
    }
    mu /= n;
    double of_sources = 0;
    double of_averages = 0;
    for (std::size_t t = 0; t < own.size(); ++t) {
        for (auto const& [value, weight] : sources[t]) {
            of_sources += weight * (value - mu) * (value - mu) / n;
        }
        if (!sources[t].empty()) {
            of_averages += (averages[t] - mu) * (averages[t] - mu) / n;
        }
    }
    auto const gain = of_averages > 0 ? std::min(most_gain, std::sqrt(of_sources) / std::sqrt(of_averages)) : 1.0;
    auto result = own;
    for (std::size_t t = 0; t < own.size(); ++t) {
        if (!sources[t].empty()) {
            result[t] = (1 - strength[t]) * own[t] + strength[t] * (mu + gain * (averages[t] - mu));
        }
    }
    return result;
}

} // namespace genrender::testing
