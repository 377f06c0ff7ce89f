// SPDX-License-Identifier: MIT
// The extents of a run's frames: what is shown, what the network renders, and how many pixels of the maps lie under one.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

namespace genrender::examples {

/// Networks take whole multiples of some number of pixels, so they may render more than is shown: what is too much lies on
/// the right and below, shows nothing, and is cut from the frames.
struct frame_extents {
    grid_extents shown;         ///< of a frame in pixels
    grid_extents rendered;      ///< of what the network renders, at least `shown`
    std::size_t map_pixels = 1; ///< of the maps along a side of a pixel of a frame

    /// Extents of the maps that the run takes.
    grid_extents maps() const { return {rendered.height * map_pixels, rendered.width * map_pixels}; }
    /// Extents of the part of them that is shown.
    grid_extents shown_maps() const { return {shown.height * map_pixels, shown.width * map_pixels}; }
    /// Whether frames are cut.
    bool is_cut() const { return rendered != shown; }
};

/// `width x height`, as people say it.
inline std::string size_text(grid_extents grid) {
    return std::to_string(grid.width) + " x " + std::to_string(grid.height);
}

/// Frames of `shown` pixels over maps that are still to be made.
inline frame_extents extents_of_frames(grid_extents shown, std::size_t multiple, std::size_t map_pixels) {
    auto const up = [multiple](std::size_t side) { return (side + multiple - 1) / multiple * multiple; };
    return {shown, {up(shown.height), up(shown.width)}, map_pixels};
}

/// Frames as near to `height` pixels as maps of `maps` have them, with a whole number of their pixels, in both
/// directions, under one of a frame; what is left of the maps on the right and below is less than one. Throws value_error
/// if the maps are lower than that, or if `width` is told and is not the maps'.
inline frame_extents extents_over_maps(grid_extents maps, std::size_t height, std::optional<std::size_t> width,
                                       std::size_t multiple) {
    require_value(height <= maps.height, "--size", "height", height,
                  ("at most the maps', which are " + size_text(maps)).c_str());
    auto const ratio = static_cast<double>(maps.height) / static_cast<double>(height);
    auto const pixels = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(ratio)));
    grid_extents const shown{maps.height / pixels, maps.width / pixels};
    require_value(shown.width > 0, "--size", "height", height, "more, or wider maps");
    require_value(width.value_or(shown.width) == shown.width, "--width", "width", width.value_or(0),
                  (std::to_string(shown.width) + ", as the maps have it at this height").c_str());
    return extents_of_frames(shown, multiple, pixels);
}

/// What a person should know of them, who asked for `height` pixels; empty if nothing.
inline std::string note_on(frame_extents const& extents, std::size_t height) {
    std::string text;
    if (extents.shown.height != height) {
        text = "Frames are " + size_text(extents.shown) + ", the nearest to a height of " + std::to_string(height) +
               " with whole pixels of the maps (" + std::to_string(extents.map_pixels) + ") under each of theirs.";
    }
    if (extents.is_cut()) {
        text += (text.empty() ? "" : " ") + ("The network renders " + size_text(extents.rendered) +
                                             ", of which the frames' " + size_text(extents.shown) + " are kept.");
    }
    return text;
}

} // namespace genrender::examples
