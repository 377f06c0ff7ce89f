// SPDX-License-Identifier: MIT
// [GR sec. 3] How finely a canonical coordinate was stored: its distinct values, and the quantum they are multiples of.
#pragma once

#include <genrender/core/begin_header.inl>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace genrender {

/// The values that one coordinate of an object takes in the maps.
struct coordinate_levels {
    std::size_t samples = 0;  ///< values looked at
    std::size_t distinct = 0; ///< different ones among them
    /// How many different ones lie in each sixteenth of [0, 1) of a texture, after whole tiles are taken off, or of the
    /// object's range of positions.
    std::array<std::size_t, 16> histogram{};
    /// Distance of neighbouring levels, in canonical units, where all values lie on levels.
    std::optional<double> quantum;
    double quantum_in_pixels =
        0;                     ///< as many map pixels share a level along the axis of steepest change; 0 without levels
    bool is_eight_bit = false; ///< the levels are those of 8 bits
    bool is_rough = false;     ///< steps from pixel to pixel differ by whole levels, as rounding makes them

    /// Whether rounding moves points by so much of a map pixel that it shows. Levels that a flat surface meets pixel by
    /// pixel are no rounding.
    bool is_quantised() const { return quantum && quantum_in_pixels > 0.125 && (is_eight_bit || is_rough); }
};

namespace detail {

/// Number of levels of [0, 1] on which 99 of 100 values lie; none if the values are too few or too fine.
inline std::optional<std::size_t> level_count(std::vector<double> const& values) {
    auto const lie_on = [&](std::size_t levels) {
        auto const n = static_cast<double>(levels);
        std::size_t beside = 0;
        for (auto const value : values) {
            auto const place = value * n;
            // A float is off by 6e-8 of itself.
            beside += std::abs(place - std::round(place)) > 1e-3 + 1.2e-7 * std::max(n, std::abs(place));
        }
        return 100 * beside <= values.size();
    };
    for (std::size_t bits = 4; bits <= 14; ++bits) {
        for (auto const levels : {(std::size_t{1} << bits) - 1, std::size_t{1} << bits}) {
            if (lie_on(levels)) {
                return levels;
            }
        }
    }
    for (std::size_t const decimal : {100U, 1000U, 10000U}) {
        if (lie_on(decimal)) {
            return decimal;
        }
    }
    return std::nullopt;
}

} // namespace detail

/// Looks at the finite `values` of a coordinate, which change by `slope` from pixel to pixel (typically, canonical
/// units). `bends` are differences of successive steps from pixel to pixel, few of them across seams. Values are levels
/// of [origin, origin + extent]: 0 and 1 for textures, the object's range for positions.
inline coordinate_levels levels_of(std::vector<float> values, std::vector<float> const& bends, double slope,
                                   double origin, double extent) {
    coordinate_levels result;
    result.samples = values.size();
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    result.distinct = values.size();
    if (!(extent > 0) || result.distinct < 4 || result.samples < 32) {
        return result; // a constant has no quantum
    }
    std::vector<double> places;
    std::size_t halves = 0;
    for (auto const value : values) {
        places.push_back((double{value} - origin) / extent);
        auto const inside = places.back() - std::floor(places.back());
        ++result.histogram[std::min<std::size_t>(15, static_cast<std::size_t>(inside * 16))];
        // A half has 10 bits of mantissa, 13 fewer than a float.
        halves += (std::bit_cast<std::uint32_t>(value) & 0x1FFFU) == 0;
    }
    auto const levels = detail::level_count(places);
    if (levels) {
        result.quantum = extent / static_cast<double>(*levels);
        result.is_eight_bit = *levels == 255;
    } else if (100 * halves >= 99 * values.size()) {
        auto const middle = std::abs(double{values[values.size() / 2]});
        result.quantum = middle > 0 ? std::exp2(std::floor(std::log2(middle)) - 10) : 0x1p-24;
    } else {
        return result;
    }
    result.quantum_in_pixels = slope > 0 ? *result.quantum / slope : 0;
    auto const by_levels = std::count_if(bends.begin(), bends.end(),
                                         [&](float bend) { return std::abs(double{bend}) > 0.4 * *result.quantum; });
    result.is_rough = 10 * static_cast<std::size_t>(by_levels) > bends.size();
    return result;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
