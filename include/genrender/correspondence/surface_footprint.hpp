// SPDX-License-Identifier: MIT
// How much of a surface one pixel covers: derivatives of canonical coordinates along the screen.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/maps/canonical_maps.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace genrender {

/// The parallelogram of a surface under one pixel, in canonical coordinates.
template <std::size_t D>
struct surface_footprint {
    std::array<float, D> across{}; ///< change of the canonical point from the pixel to the one on its right
    std::array<float, D> down{};   ///< change from the pixel to the one below

    /// Area in squared canonical units: sqrt(|across|^2 |down|^2 - (across . down)^2), which is |det| in two
    /// dimensions.
    double area() const {
        auto const aa = dot(across, across);
        auto const dd = dot(down, down);
        auto const ad = dot(across, down);
        return std::sqrt(std::max(0.0, aa * dd - ad * ad));
    }

    /// a . b, in double precision.
    static double dot(std::array<float, D> const& a, std::array<float, D> const& b) {
        double sum = 0;
        for (std::size_t d = 0; d < D; ++d) {
            sum += double{a[d]} * double{b[d]};
        }
        return sum;
    }
};

/// Where a place lies from a pixel's own, on the plane that the pixel's footprint spans.
struct screen_offset {
    double right = 0;     ///< in pixels
    double down = 0;      ///< in pixels
    double off_plane = 0; ///< in canonical units; 0 in two dimensions
};

/// The offset of `place` from `origin` in the pixels of a footprint at `origin`: least squares of origin + right across
/// + down down = place. The footprint's area is not 0.
template <std::size_t D>
screen_offset offset_on(surface_footprint<D> const& footprint, std::array<float, D> const& origin,
                        std::array<float, D> const& place) {
    using of = surface_footprint<D>;
    std::array<float, D> way{};
    for (std::size_t d = 0; d < D; ++d) {
        way[d] = place[d] - origin[d];
    }
    auto const aa = of::dot(footprint.across, footprint.across);
    auto const dd = of::dot(footprint.down, footprint.down);
    auto const ad = of::dot(footprint.across, footprint.down);
    auto const wa = of::dot(way, footprint.across);
    auto const wd = of::dot(way, footprint.down);
    auto const determinant = aa * dd - ad * ad;
    screen_offset offset{(wa * dd - wd * ad) / determinant, (wd * aa - wa * ad) / determinant, 0};
    if constexpr (D > 2) {
        auto const on_plane = offset.right * wa + offset.down * wd;
        offset.off_plane = std::sqrt(std::max(0.0, of::dot(way, way) - on_plane));
    }
    return offset;
}

/// Whether two seen surfaces face the same way in canonical space: their oriented areas agree in sign (D = 2) or their
/// normals meet at less than a right angle (D = 3). What is seen twice of one surface does.
template <std::size_t D>
bool faces_alike(surface_footprint<D> const& a, surface_footprint<D> const& b) {
    // The product of the oriented areas, by Lagrange's identity: (a1 x a2) . (b1 x b2) = (a1.b1)(a2.b2) -
    // (a1.b2)(a2.b1).
    using of = surface_footprint<D>;
    return of::dot(a.across, b.across) * of::dot(a.down, b.down) -
               of::dot(a.across, b.down) * of::dot(a.down, b.across) >
           0;
}

/// The footprint of a covered pixel from its neighbours of the same object: along each axis the shorter of the two
/// one-sided differences, which is the one that does not cross a chart's border or a fold. None where an axis has no
/// such neighbour or the coordinates do not change with the pixel.
template <canonical_maps Maps>
std::optional<surface_footprint<Maps::dimensions>> footprint_at(Maps const& maps, frame_index i, pixel p) {
    constexpr auto D = Maps::dimensions;
    auto const here = maps.point_at(i, p);
    auto const object = maps.object_at(i, p);
    auto const shorter_difference = [&](std::int64_t row_step, std::int64_t column_step) {
        std::optional<std::array<float, D>> best;
        for (std::int64_t const side : {1, -1}) {
            auto const row = std::int64_t{p.row} + side * row_step;
            auto const column = std::int64_t{p.column} + side * column_step;
            if (row < 0 || column < 0 || row >= static_cast<std::int64_t>(maps.grid().height) ||
                column >= static_cast<std::int64_t>(maps.grid().width)) {
                continue;
            }
            pixel const next{static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column)};
            if (!maps.is_covered(i, next) || maps.object_at(i, next) != object) {
                continue;
            }
            auto const there = maps.point_at(i, next);
            std::array<float, D> difference{};
            for (std::size_t d = 0; d < D; ++d) {
                difference[d] = static_cast<float>(side) * (there[d] - here[d]);
            }
            using footprint = surface_footprint<D>;
            if (!best || footprint::dot(difference, difference) < footprint::dot(*best, *best)) {
                best = difference;
            }
        }
        return best;
    };
    auto const across = shorter_difference(0, 1);
    auto const down = shorter_difference(1, 0);
    if (!across || !down) {
        return std::nullopt;
    }
    surface_footprint<D> const footprint{*across, *down};
    auto const area = footprint.area();
    return area > 0 && is_finite(area) ? std::optional(footprint) : std::nullopt;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
