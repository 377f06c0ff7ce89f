// SPDX-License-Identifier: MIT
// [GR sec. 4] How much the pixels that show one surface point differ between frames.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/evaluation/pixel_objects.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace genrender {

/// The error at one interval.
struct interval_error {
    std::size_t interval = 0;    ///< frames between the two images of a pair
    std::size_t pairs = 0;       ///< of pixels that show the same surface point
    std::optional<double> error; ///< none without pairs
};

/// A surface point that names its object, an optional capability of a correspondence_map's point_type; without it
/// objects cannot be chosen.
///
/// expression     | type         | meaning
/// ---------------|--------------|------------------------------------------------------------------------------------
/// `point.object` | object_index | the object whose surface it is on
template <class Point>
concept point_of_object = requires(Point const& point) {
    { point.object } -> std::convertible_to<object_index>;
};

namespace detail {

/// Whether the object of a surface point counts; without a choice, a map's points need not name their object.
template <class Point, object_predicate Counts>
bool point_counts(Point const& point, Counts const& counts) {
    if constexpr (std::same_as<Counts, every_object>) {
        return true;
    } else {
        return counts(point.object);
    }
}

/// Calls `visit(i, q, j, p)` for every pair of pixels q of frame i and p of frame j = i + interval that show the same
/// surface point of an object that counts.
template <correspondence_map Map, object_predicate Counts, class Visit>
void visit_pairs(Map const& map, std::size_t interval, Counts const& counts, Visit const& visit) {
    auto const tokens = grid_extents(map.grid()).size();
    for (std::size_t later = interval; later < map.frame_count(); ++later) {
        frame_index const i{static_cast<std::uint32_t>(later - interval)};
        frame_index const j{static_cast<std::uint32_t>(later)};
        for (std::uint32_t p = 0; p < tokens; ++p) {
            auto const point = map.point_at(j, {p});
            auto const is_chosen = point && point_counts(*point, counts);
            if (auto const q = is_chosen ? map.token_at(i, *point) : std::nullopt) {
                visit(i, *q, j, token_index{p});
            }
        }
    }
}

} // namespace detail

/// Root of the mean squared difference, over all channels, between pixels of frames i and i + interval that show the
/// same surface point and are visible in both, over all i, for each interval; in the units of the images. `images`
/// [frames, channels, height, width]; `map` holds the correspondences at the images' resolution: pixel_correspondence
/// for pairs that lie a fraction of a pixel apart, any other map for its own. Background never counts; `counts` chooses
/// objects, which takes a map whose points have an `object`. Blurring lowers the error too: print contrast beside it.
/// Throws shape_error if images and map differ, value_error for an interval of 0.
template <class Real, correspondence_map Map, object_predicate Counts = every_object>
    requires std::same_as<Counts, every_object> || point_of_object<typename Map::point_type> std::vector<interval_error>
    correspondence_errors(strided_view<Real, 4> images, Map const& map, std::span<std::size_t const> intervals,
                          Counts const& counts = {}) {
        auto const grid = grid_extents(map.grid());
        require_extents("correspondence_error", "images", images.extents(),
                        std::array{std::size_t(map.frame_count()), images.extent(1), grid.height, grid.width});
        std::vector<interval_error> result;
        for (auto const interval : intervals) {
            require_value(interval > 0, "correspondence_error", "interval", interval, "at least 1");
            double squares = 0;
            std::size_t pairs = 0;
            detail::visit_pairs(map, interval, counts, [&](auto i, auto q, auto j, auto p) {
                ++pairs;
                for (std::size_t c = 0; c < images.extent(1); ++c) {
                    auto const difference =
                        static_cast<double>(images(j.value, c, p.value / grid.width, p.value % grid.width)) -
                        static_cast<double>(images(i.value, c, q.value / grid.width, q.value % grid.width));
                    squares += difference * difference;
                }
            });
            auto const count = static_cast<double>(pairs * images.extent(1));
            result.push_back({interval, pairs, count > 0 ? std::optional(std::sqrt(squares / count)) : std::nullopt});
        }
        return result;
    }

/// The error at one interval over all objects, see correspondence_errors; none if there is no pair of pixels.
template <class Real, correspondence_map Map>
std::optional<double> correspondence_error(strided_view<Real, 4> images, Map const& map, std::size_t interval) {
    return correspondence_errors(images, map, std::array{interval}).front().error;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
