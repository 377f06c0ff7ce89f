// SPDX-License-Identifier: MIT
// How unlike the places that show one surface point look to an encoder of images: MEt3R by true correspondences.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/evaluation/correspondence_error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace genrender {

namespace detail {

/// The features [channels] at the middle of a pixel of `grid`, between the four places of `map` [channels, rows,
/// columns] around it; beyond the outermost places theirs.
template <class Real>
void sample_features(std::vector<double>& into, strided_view<Real, 3> map, grid_extents grid, std::size_t pixel) {
    struct axis {
        std::size_t low, high;
        double share; ///< of the higher one
    };
    auto const place = [](std::size_t at, std::size_t pixels, std::size_t places) {
        auto const last = static_cast<double>(places - 1);
        auto const x = (static_cast<double>(at) + 0.5) * static_cast<double>(places) / static_cast<double>(pixels);
        auto const inside = std::clamp(x - 0.5, 0.0, last);
        auto const low = std::floor(inside);
        return axis{static_cast<std::size_t>(low), static_cast<std::size_t>(std::min(low + 1, last)), inside - low};
    };
    auto const [top, bottom, down] = place(pixel / grid.width, grid.height, map.extent(1));
    auto const [left, end, right] = place(pixel % grid.width, grid.width, map.extent(2));
    for (std::size_t c = 0; c < into.size(); ++c) {
        auto const of_row = [&, l = left, e = end, r = right](std::size_t row) {
            return (1 - r) * static_cast<double>(map(c, row, l)) + r * static_cast<double>(map(c, row, e));
        };
        into[c] = (1 - down) * of_row(top) + down * of_row(bottom);
    }
}

} // namespace detail

/// Mean of 1 - cos(F_i(q), F_j(p)), in [0, 2], over all pairs of pixels q of frame i and p of frame i + interval that show
/// the same surface point, for each interval: 0 where both look the same. F are `features` [frames, channels, rows,
/// columns] of an encoder of images (reference_clip::image_features), on any grid, between whose places they are
/// interpolated; a place without features is like none. `map` and `counts` as in correspondence_errors. MEt3R (Asim et
/// al. 2025, eq. 3) with pairs that are known instead of guessed. Throws shape_error if frames differ in number or the
/// features have no places, value_error for an interval of 0.
template <class Real, correspondence_map Map, object_predicate Counts = every_object>
    requires std::same_as<Counts, every_object> || point_of_object<typename Map::point_type> std::vector<interval_error>
    perceptual_errors(strided_view<Real, 4> features, Map const& map, std::span<std::size_t const> intervals,
                      Counts const& counts = {}) {
        auto const grid = grid_extents(map.grid());
        require_extents("perceptual_errors", "features", features.extents(),
                        std::array{std::size_t(map.frame_count()), std::max<std::size_t>(1, features.extent(1)),
                                   std::max<std::size_t>(1, features.extent(2)),
                                   std::max<std::size_t>(1, features.extent(3))});
        std::vector<double> earlier(features.extent(1));
        std::vector<double> later(features.extent(1));
        std::vector<interval_error> result;
        for (auto const interval : intervals) {
            require_value(interval > 0, "perceptual_errors", "interval", interval, "at least 1");
            double sum = 0;
            std::size_t pairs = 0;
            detail::visit_pairs(map, interval, counts, [&](auto i, auto q, auto j, auto p) {
                detail::sample_features(earlier, features[i.value], grid, q.value);
                detail::sample_features(later, features[j.value], grid, p.value);
                double product = 0;
                double earlier_squared = 0;
                double later_squared = 0;
                for (std::size_t c = 0; c < earlier.size(); ++c) {
                    product += earlier[c] * later[c];
                    earlier_squared += earlier[c] * earlier[c];
                    later_squared += later[c] * later[c];
                }
                auto const lengths = std::sqrt(earlier_squared) * std::sqrt(later_squared);
                sum += 1 - (lengths > 0 ? std::clamp(product / lengths, -1.0, 1.0) : 0.0);
                ++pairs;
            });
            result.push_back(
                {interval, pairs, pairs > 0 ? std::optional(sum / static_cast<double>(pairs)) : std::nullopt});
        }
        return result;
    }

} // namespace genrender

#include <genrender/core/end_header.inl>
