// SPDX-License-Identifier: MIT
// [GR sec. 3] What can be wrong with one pixel of the maps: a seam beside it, a blend of two surfaces, a point shown
// twice.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/inspection/screen_search.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace genrender {

/// A step from one pixel to another, in pixels.
struct pixel_step {
    std::int64_t down = 0;  ///< rows, negative upwards
    std::int64_t right = 0; ///< columns, negative to the left
};

/// The pixel a step away, if the map has one.
inline std::optional<pixel> stepped(pixel p, pixel_step step, grid_extents grid) {
    auto const row = std::int64_t{p.row} + step.down;
    auto const column = std::int64_t{p.column} + step.right;
    if (row < 0 || column < 0 || row >= static_cast<std::int64_t>(grid.height) ||
        column >= static_cast<std::int64_t>(grid.width)) {
        return std::nullopt;
    }
    return pixel{static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column)};
}

/// The canonical point a step away from a covered pixel, if it is finite and of the same object.
template <canonical_maps Maps>
std::optional<std::array<float, Maps::dimensions>> point_beside(Maps const& maps, frame_index i, pixel p,
                                                                pixel_step step) {
    auto const there = stepped(p, step, maps.grid());
    if (!there || !maps.is_covered(i, *there) || maps.object_at(i, *there) != maps.object_at(i, p)) {
        return std::nullopt;
    }
    auto const point = maps.point_at(i, *there);
    return is_finite(point) ? std::optional(point) : std::nullopt;
}

/// Distance of two canonical points.
template <std::size_t D>
double distance_between(std::array<float, D> const& a, std::array<float, D> const& b) {
    double sum = 0;
    for (std::size_t d = 0; d < D; ++d) {
        sum += (double{a[d]} - double{b[d]}) * (double{a[d]} - double{b[d]});
    }
    return std::sqrt(sum);
}

/// Whether a seam runs between a covered pixel of finite coordinates and the next one along `step`: their points lie
/// more than 8 `side` apart, the median side of the object's pixels in canonical units, and 4 times as far as the
/// pixels before and behind, which tells a seam from a surface seen at a grazing angle. None without a next pixel of
/// the same object.
template <canonical_maps Maps>
std::optional<bool> is_seam(Maps const& maps, frame_index i, pixel p, pixel_step step, double side) {
    auto const here = maps.point_at(i, p);
    auto const next = point_beside(maps, i, p, step);
    if (!next) {
        return std::nullopt;
    }
    auto const leap = distance_between(here, *next);
    auto const before = point_beside(maps, i, p, {-step.down, -step.right});
    auto const behind = point_beside(maps, i, p, {2 * step.down, 2 * step.right});
    return leap > 8 * side && !(before && leap <= 4 * distance_between(*before, here)) &&
           !(behind && leap <= 4 * distance_between(*next, *behind));
}

/// Whether a covered pixel on the silhouette of its object holds a blend of what lies on both sides, as antialiasing
/// makes it: its point is 8 times as far from where the second and third pixels inwards lead to as those are apart, and
/// 4 `side` away. (The first may be blended too.) None for a pixel that is not on a silhouette or has no three pixels
/// of the object behind it.
template <canonical_maps Maps>
std::optional<bool> is_blended_edge(Maps const& maps, frame_index i, pixel p, double side) {
    auto const here = maps.point_at(i, p);
    std::optional<bool> blended;
    for (auto const inwards : {pixel_step{0, 1}, pixel_step{0, -1}, pixel_step{1, 0}, pixel_step{-1, 0}}) {
        auto const outside = stepped(p, {-inwards.down, -inwards.right}, maps.grid());
        if (!outside || (maps.is_covered(i, *outside) && maps.object_at(i, *outside) == maps.object_at(i, p))) {
            continue;
        }
        auto const first = point_beside(maps, i, p, inwards);
        auto const second = point_beside(maps, i, p, {2 * inwards.down, 2 * inwards.right});
        auto const third = point_beside(maps, i, p, {3 * inwards.down, 3 * inwards.right});
        if (!first || !second || !third) {
            continue;
        }
        auto expected = *second;
        for (std::size_t d = 0; d < expected.size(); ++d) {
            expected[d] += 2 * ((*second)[d] - (*third)[d]);
        }
        auto const error = distance_between(here, expected);
        auto const is_far = error > 8 * distance_between(*second, *third) && error > 4 * side;
        // Seen along two axes, a surface that continues along one of them is no blend.
        blended = blended.value_or(true) && is_far;
    }
    return blended;
}

/// Which other pixels of a frame show the point of a pixel.
struct point_claims {
    bool same = false;     ///< one that sees the surface from the same side
    bool mirrored = false; ///< one that sees it from the other side, as the second half of a mirrored texture is seen
    /// Whether there is one of either kind.
    bool any() const { return same || mirrored; }
};

/// The claims on the point of a covered pixel by pixels of the same object more than 2 pixels away. `search` is that of
/// the frame; it sees the claims of surfaces that appear up to about 2.5 times smaller. Blended edges, by `side` as in
/// is_blended_edge, claim nothing: a blend of two places is a third one, which something else shows rightly. None for a
/// pixel that is one or has no footprint.
template <canonical_maps Maps>
std::optional<point_claims> claims_on(Maps const& maps, screen_search<Maps> const& search, frame_index i, pixel p,
                                      double side) {
    auto const footprint = footprint_at(maps, i, p);
    if (!footprint || is_blended_edge(maps, i, p, side).value_or(false)) {
        return std::nullopt;
    }
    point_claims claims;
    search.visit_places(maps.object_at(i, p), maps.point_at(i, p), [&](screen_place<Maps::dimensions> const& place) {
        auto const rows = std::abs(std::int64_t{place.at.row} - std::int64_t{p.row});
        auto const columns = std::abs(std::int64_t{place.at.column} - std::int64_t{p.column});
        if (std::max(rows, columns) > 2 && !is_blended_edge(maps, i, place.at, side).value_or(false)) {
            (faces_alike(*footprint, place.footprint) ? claims.same : claims.mirrored) = true;
        }
    });
    return claims;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
