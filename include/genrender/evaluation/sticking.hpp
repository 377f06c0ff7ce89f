// SPDX-License-Identifier: MIT
// Whether what is painted goes along with the surface or stays where it is on the screen.
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

/// The two errors of moving pixels at one interval.
struct interval_sticking {
    std::size_t interval = 0; ///< frames between the two images of a pair
    std::size_t pairs = 0;    ///< of moving pixels
    double along_surface = 0; ///< root of the mean squared difference between pixels of one surface point
    double at_place = 0;      ///< the same between the same places of the screen
    std::optional<double>
        ratio; ///< along_surface / at_place; none without pairs, or where nothing changes at the places
};

/// e(surface) / e(screen) for each interval, over pairs of pixels q of frame i and p of frame j = i + interval that show
/// the same surface point at least `least_motion` pixels apart on the screen, and whose place p shows the same object in
/// frame i: e(surface)^2 is the mean of (x_j(p) - x_i(q))^2 over all channels, e(screen)^2 that of (x_j(p) - x_i(p))^2.
/// Paint that goes along has a ratio towards 0, unrelated frames have 1, and what sticks to the screen has more. Both
/// errors are of the same pixels of the same pictures, so that blurring takes from both. `images`, `map` and `counts` as
/// in correspondence_errors. Throws as that does, and value_error unless least_motion is above 0.
template <class Real, correspondence_map Map, object_predicate Counts = every_object>
    requires point_of_object<typename Map::point_type> std::vector<interval_sticking>
    sticking(strided_view<Real, 4> images, Map const& map, std::span<std::size_t const> intervals,
             Counts const& counts = {}, double least_motion = 2) {
        auto const grid = grid_extents(map.grid());
        require_extents("sticking", "images", images.extents(),
                        std::array{std::size_t(map.frame_count()), images.extent(1), grid.height, grid.width});
        require_value(least_motion > 0, "sticking", "least_motion", least_motion, "above 0");
        auto const apart = [&](std::size_t p, std::size_t q) {
            auto const difference = [](std::size_t a, std::size_t b) {
                return static_cast<double>(a) - static_cast<double>(b);
            };
            return std::hypot(difference(p / grid.width, q / grid.width), difference(p % grid.width, q % grid.width));
        };
        std::vector<interval_sticking> result;
        for (auto const interval : intervals) {
            require_value(interval > 0, "sticking", "interval", interval, "at least 1");
            interval_sticking found;
            found.interval = interval;
            detail::visit_pairs(map, interval, counts, [&](auto i, auto q, auto j, auto p) {
                auto const before = apart(p.value, q.value) >= least_motion ? map.point_at(i, p) : std::nullopt;
                if (!before || before->object != map.point_at(j, p)->object) {
                    return;
                }
                ++found.pairs;
                for (std::size_t c = 0; c < images.extent(1); ++c) {
                    auto const value = [&](auto frame, auto token) {
                        return static_cast<double>(
                            images(frame.value, c, token.value / grid.width, token.value % grid.width));
                    };
                    auto const surface = value(j, p) - value(i, q);
                    auto const place = value(j, p) - value(i, p);
                    found.along_surface += surface * surface;
                    found.at_place += place * place;
                }
            });
            auto const count = static_cast<double>(std::max<std::size_t>(1, found.pairs * images.extent(1)));
            found.along_surface = std::sqrt(found.along_surface / count);
            found.at_place = std::sqrt(found.at_place / count);
            if (found.at_place > 0) {
                found.ratio = found.along_surface / found.at_place;
            }
            result.push_back(found);
        }
        return result;
    }

} // namespace genrender

#include <genrender/core/end_header.inl>
