// SPDX-License-Identifier: MIT
// [GR sec. 3.2] What how well keyframes see a texel does to their shares in the average texture, and to who takes part.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/texel_weights.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/index.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace genrender {

/// How the average texture weighs the keyframes that see a texel.
enum class texel_average : std::uint8_t {
    plain,      ///< all alike (the paper's)
    by_quality, ///< by how well they see it, where the correspondence says (graded_correspondence_map)
    winner      ///< the one that sees it best alone; of those that see it alike, the earliest frame
};

/// What qualities do, in one step.
struct quality_weights {
    double exponent = 1; ///< of texel_average::by_quality: shares are quality^exponent; 0: all alike
    double threshold =
        0; ///< a keyframe that sees a point with less than this times the frame's own quality is not taken

    /// Whether nothing differs from shares in proportion to quality.
    bool are_plain() const { return exponent == 1 && threshold <= 0; }
};

/// Qualities over the steps of a run.
struct quality_settings {
    double exponent_begin = 1; ///< of the first step; between the first and the last it runs in a straight line
    double exponent_end = 1;   ///< of the last step
    /// Least quality of a match, as a share of the quality with which the frame sees the point itself; matches below are
    /// none, and a token whose matches all are is not covered. 0 takes all. Of no effect where the correspondence knows
    /// no quality.
    double threshold = 0;

    /// Those of a step.
    quality_weights at(std::size_t step, std::size_t steps) const {
        auto const share = steps > 1 ? static_cast<double>(step) / static_cast<double>(steps - 1) : 0.0;
        return {exponent_begin + share * (exponent_end - exponent_begin), threshold};
    }
};

/// Throws value_error, in the name of `function`, for exponents or a threshold that are negative or not finite; `owner` is
/// what has them, with a dot.
inline void require_quality_settings(char const* function, quality_settings const& settings,
                                     std::string const& owner = "") {
    auto const require = [&](char const* argument, double value) {
        require_value(is_finite(value) && value >= 0, function, (owner + argument).c_str(), value,
                      "a finite number, 0 or more");
    };
    require("quality.exponent_begin", settings.exponent_begin);
    require("quality.exponent_end", settings.exponent_end);
    require("quality.threshold", settings.threshold);
}

/// Whether a match is good enough: its quality is at least threshold * own. Where either is not known, it is.
constexpr bool is_good_match(double quality, double own, double threshold) {
    return !(quality > 0 && own > 0) || quality >= threshold * own;
}

/// Turns the qualities with which the keyframes `frames` see a texel into their shares in the average texture, which sum
/// to 1: alike (plain, and where all qualities are 0), quality^exponent over its sum, or 1 for the winner.
inline void average_shares(std::span<double> qualities, std::span<frame_index const> frames, texel_average average,
                           double exponent) {
    auto const seen = qualities.size();
    if (seen == 0) {
        return;
    }
    auto const best = *std::max_element(qualities.begin(), qualities.end());
    if (average == texel_average::winner) {
        std::size_t winner = seen;
        for (std::size_t k = 0; k < seen; ++k) {
            if (qualities[k] == best && (winner == seen || frames[k] < frames[winner])) {
                winner = k;
            }
        }
        std::fill(qualities.begin(), qualities.end(), 0.0);
        qualities[winner] = 1;
        return;
    }
    if (average == texel_average::plain || !(best > 0) || exponent == 0) {
        std::fill(qualities.begin(), qualities.end(), average_weight<double>(seen));
        return;
    }
    double sum = 0;
    for (auto& quality : qualities) {
        quality = std::pow(quality / best, exponent);
        sum += quality;
    }
    for (auto& quality : qualities) {
        quality /= sum;
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
