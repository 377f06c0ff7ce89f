// SPDX-License-Identifier: MIT
// [GR sec. 3] A finding of the pre-flight: what was found, where and how much of it. Its sentence is the program's.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace genrender {

/// What a recommendation is about. `figure` is what stands behind each.
enum class recommendation_kind : std::uint8_t {
    no_frames,             ///< the maps have no frames or no pixels
    nothing_visible,       ///< frames that show no object; number of them
    one_frame,             ///< nothing to keep consistent
    identical_frames,      ///< frames like the one before; number of them
    no_background,         ///< frames without background; number of them
    not_finite,            ///< number of pixels whose coordinates are NaN or infinite
    degenerate,            ///< share of pixels whose coordinates do not change with the pixel
    tiny_object,           ///< pixels of an object in each frame that shows it, on average
    mirrored,              ///< share of pixels shown elsewhere, from the other side
    overlapping,           ///< share of pixels shown elsewhere, from the same side
    tiled,                 ///< share of pixels whose place on the texture is used in another tile too
    out_of_range,          ///< share of pixels outside [0, 1]
    eight_bit,             ///< map pixels that share a value
    quantised,             ///< map pixels that share a value
    blended_edges,         ///< share of silhouette pixels that are blended
    many_seams,            ///< share of neighbouring pixels with a seam between them
    keyframes_refused,     ///< they cannot be drawn
    grid_refused,          ///< the correspondence cannot be made
    low_coverage,          ///< share of tokens that keyframes cover
    low_hit_rate,          ///< share of seen tokens that are found
    great_error,           ///< of found tokens, in feature pixels
    texture_too_fine,      ///< share of seen tokens that meet in a texel
    texture_too_coarse,    ///< error of tokens that meet in a texel, in feature pixels
    maps_too_coarse,       ///< map pixels along a token
    maps_finer_than_needed ///< map pixels along a token of the finest grid
};

/// Their names, in this order.
inline constexpr std::array<std::string_view, 25> recommendation_names{
    "no_frames",   "nothing_visible",   "one_frame",          "identical_frames", "no_background",
    "not_finite",  "degenerate",        "tiny_object",        "mirrored",         "overlapping",
    "tiled",       "out_of_range",      "eight_bit",          "quantised",        "blended_edges",
    "many_seams",  "keyframes_refused", "grid_refused",       "low_coverage",     "low_hit_rate",
    "great_error", "texture_too_fine",  "texture_too_coarse", "maps_too_coarse",  "maps_finer_than_needed"};

/// One finding, in figures. Programs say it in words and add how their users ask for the remedy.
struct recommendation {
    recommendation_kind kind;             ///< which finding
    double figure = 0;                    ///< its figure, whose meaning and unit are the kind's
    std::optional<object_index> object{}; ///< the object that it is about; none if it is about all
    std::optional<grid_extents> grid{};   ///< the feature resolution that it is about; none if it is about all
    std::vector<frame_index> frames{};    ///< ascending; empty where it is about all
    std::string detail{};                 ///< of the refusals: the sentence of the one who refused

    /// Whether a run would refuse these maps or settings.
    bool forbids_run() const {
        return kind == recommendation_kind::no_frames || kind == recommendation_kind::not_finite ||
               kind == recommendation_kind::keyframes_refused || kind == recommendation_kind::grid_refused;
    }

    /// The kind as a word, the name of its enumerator.
    std::string_view name() const { return recommendation_names[static_cast<std::size_t>(kind)]; }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
