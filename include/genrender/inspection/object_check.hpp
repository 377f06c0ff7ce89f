// SPDX-License-Identifier: MIT
// [GR sec. 3] What can be told of an object and of a frame by the maps alone.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/inspection/coordinate_levels.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace genrender {

/// Part of a whole, in [0, 1]; 0 of nothing.
inline double share_of(std::size_t part, std::size_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

/// What the maps tell of one object.
struct object_check {
    object_index object;                      ///< whose figures these are
    std::size_t pixels = 0;                   ///< covered by it, all frames together
    std::vector<frame_index> frames;          ///< that show it
    std::vector<std::array<double, 2>> range; ///< lowest and greatest finite value of each coordinate; none if none is
    std::size_t not_finite = 0;               ///< pixels with a coordinate that is NaN or infinite
    std::vector<frame_index> not_finite_frames; ///< that have such pixels
    std::size_t out_of_range = 0;               ///< UV only: pixels outside [0, 1]
    std::size_t tiled = 0; ///< UV only: pixels whose place on the texture is used in another tile too

    // Of the frames and pixels looked at
    std::size_t looked_at = 0;             ///< pixels of finite coordinates
    std::size_t without_footprint = 0;     ///< of these, whose coordinates do not change with the pixel, or alone
    double side = 0;                       ///< median side of a pixel's footprint, canonical units
    std::size_t pairs = 0;                 ///< neighbouring pixels
    std::size_t seams = 0;                 ///< of these, with a seam between them (is_seam)
    std::size_t edges = 0;                 ///< pixels on the silhouette
    std::size_t blended_edges = 0;         ///< of these, blended (is_blended_edge)
    std::size_t asked = 0;                 ///< pixels whose point was searched for (claims_on)
    std::size_t overlapping = 0;           ///< of these, shown elsewhere too, from the same side
    std::size_t mirrored = 0;              ///< of these, shown elsewhere too, from the other side
    std::vector<coordinate_levels> levels; ///< of each coordinate
};

/// What a frame shows.
struct frame_check {
    std::size_t pixels = 0;            ///< of the frame
    std::size_t covered = 0;           ///< of these, that show an object
    std::vector<object_index> objects; ///< that it shows, ascending
    bool same_as_previous = false;     ///< pixel by pixel

    /// Share of its pixels that show no object, in [0, 1].
    double background_share() const { return share_of(pixels - covered, pixels); }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
