// SPDX-License-Identifier: MIT
// [GR sec. 4] How much the pixels that show one surface point differ between frames.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/correspondence/reproject.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace genrender {

/// Root of the mean squared difference, over all channels, between pixels of frames i and i + interval that show the
/// same surface point and are visible in both, over all i; in the units of the images. None if there is no such pair of
/// pixels. `images` [frames, channels, height, width]; `map` holds the correspondences at the images' resolution.
/// Background never counts. Throws shape_error if images and map differ, value_error for an interval of 0.
template <class Real, correspondence_map Map>
std::optional<double> correspondence_error(strided_view<Real, 4> images, Map const& map, std::size_t interval) {
    auto const grid = grid_extents(map.grid());
    require_extents("correspondence_error", "images", images.extents(),
                    std::array{std::size_t(map.frame_count()), images.extent(1), grid.height, grid.width});
    require_value(interval > 0, "correspondence_error", "interval", interval, "at least 1");
    double squares = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i + interval < images.extent(0); ++i) {
        auto const from = images[i];
        auto const to = images[i + interval];
        for (std::uint32_t p = 0; p < grid.size(); ++p) {
            auto const q = corresponding_token(map, {static_cast<std::uint32_t>(i)},
                                               {static_cast<std::uint32_t>(i + interval)}, {p});
            if (!q) {
                continue;
            }
            for (std::size_t c = 0; c < images.extent(1); ++c) {
                auto const difference = static_cast<double>(to(c, p / grid.width, p % grid.width)) -
                                        static_cast<double>(from(c, q->value / grid.width, q->value % grid.width));
                squares += difference * difference;
                ++count;
            }
        }
    }
    return count > 0 ? std::optional(std::sqrt(squares / static_cast<double>(count))) : std::nullopt;
}

} // namespace genrender
