// SPDX-License-Identifier: MIT
// The findings of the pre-flight as sentences: what was found, where, how much of it, and what to do.
#pragma once

#include <genrender/core/index.hpp>
#include <genrender/inspection/recommendation.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace genrender::examples {

/// `0-3, 7`: frames in ranges; at most 8 ranges, then `...`.
inline std::string ranges_text(std::vector<frame_index> const& frames) {
    std::string text;
    std::size_t ranges = 0;
    for (std::size_t first = 0; first < frames.size();) {
        auto last = first;
        while (last + 1 < frames.size() && frames[last + 1].value == frames[last].value + 1) {
            ++last;
        }
        if (++ranges > 8) {
            return text + ", ...";
        }
        text += (first > 0 ? ", " : "") + std::to_string(frames[first].value);
        text += last > first ? "-" + std::to_string(frames[last].value) : "";
        first = last + 1;
    }
    return text;
}

namespace detail {

/// A number with as many digits as a person reads: `0.34`, `12`.
inline std::string short_number(double value) {
    std::array<char, 48> text{};
    if (value < 10) {
        std::snprintf(text.data(), text.size(), "%.2g", value);
    } else {
        std::snprintf(text.data(), text.size(), "%.0f", value);
    }
    return text.data();
}

/// `48 %`.
inline std::string percent(double share) {
    auto const value = 100 * share;
    return (value > 0 && value < 1 ? std::string("less than 1") : std::to_string(std::lround(value))) + " %";
}

} // namespace detail

/// What a person is told of a finding: figure, place and remedy.
inline std::string sentence_of(recommendation const& one) {
    using enum recommendation_kind;
    auto const& [kind, figure, object, grid, frames, refusal] = one;
    auto const of_object = object ? "object " + std::to_string(object->value) : std::string("the maps");
    auto const at_grid =
        grid ? "grid " + std::to_string(grid->height) + "x" + std::to_string(grid->width) : std::string("every grid");
    auto const in_frames = (frames.size() == 1 ? "frame " : "frames ") + ranges_text(frames);
    auto const share = detail::percent(figure);
    auto const number = detail::short_number(figure);
    std::string const rest_positions = "use rest positions as canonical coordinates";
    switch (kind) {
    case no_frames:
        return "the maps hold no pixels: give at least one frame";
    case nothing_visible:
        return "nothing is visible in " + in_frames + ": leave them out, or look where the objects are";
    case one_frame:
        return "there is one frame only, so nothing to keep consistent: give several";
    case identical_frames:
        return in_frames + (frames.size() == 1 ? " shows" : " show") +
               " what the frame before shows: render one of each and repeat it";
    case no_background:
        return "no background in " + in_frames + ": latent normalisation by background skips them";
    case not_finite:
        return "coordinates of " + of_object + " are NaN or infinite at " + std::to_string(std::llround(figure)) +
               " pixels of " + in_frames + ", which a run refuses: mark them as background or write them again";
    case degenerate:
        return "coordinates of " + of_object + " do not change over " + share + " of its pixels: unwrap it anew or " +
               rest_positions;
    case tiny_object:
        return of_object + " covers " + number +
               " map pixels a frame, less than a token of the finest grid: it keeps its own features";
    case mirrored:
        return "UVs of " + of_object + " are mirrored over " + share + " of its pixels: " + rest_positions;
    case overlapping:
        return "UVs of " + of_object + " overlap over " + share + " of its pixels: " + rest_positions;
    case tiled:
        return "UVs of " + of_object + " repeat whole tiles apart over " + share + " of its pixels: " + rest_positions;
    case out_of_range:
        return "UVs of " + of_object + " lie outside [0, 1] at " + share +
               " of its pixels: say whether the texture repeats or ends there";
    case eight_bit:
        return "coordinates of " + of_object + " are stored in 8 bits, " + number +
               " map pixels a value: write 32-bit float";
    case quantised:
        return "coordinates of " + of_object + " are rounded, " + number + " map pixels a value: write 32-bit float";
    case blended_edges:
        return "edges of " + of_object + " are antialiased at " + share +
               " of its silhouette: render one sample a pixel, without a filter";
    case many_seams:
        return share + " of neighbouring pixels of " + of_object +
               " have a seam between them: unwrap it into larger charts or " + rest_positions;
    case keyframes_refused:
        return "keyframes cannot be drawn: " + refusal;
    case grid_refused:
        return at_grid + " cannot be used: " + refusal;
    case low_coverage:
        return "keyframes cover " + share + " of the tokens of " + at_grid + ": draw more keyframes";
    case low_hit_rate:
        return "tokens of " + at_grid + " find " + share +
               " of the partners that keyframes show: render the maps in higher resolution or look at the overlaps";
    case great_error:
        return "tokens of " + at_grid + " meet " + number +
               " feature pixels from their place: render the maps in higher resolution or look at the overlaps";
    case texture_too_fine:
        return "texels are too small for " + at_grid + ", where " + share +
               " of partners meet: lower the texture resolution, or match it to the maps";
    case texture_too_coarse:
        return "texels are too large for " + at_grid + ", where partners meet " + number +
               " feature pixels from their place: raise the texture resolution, or match it to the maps";
    case maps_too_coarse:
        return at_grid + " has " + number +
               " map pixels along a token: render the maps in higher resolution, at least 4, or use lower grids";
    case maps_finer_than_needed:
        return "the maps hold " + number +
               " pixels along a token of the finest grid, where 8 are plenty: smaller ones save time and memory";
    }
    return {};
}

} // namespace genrender::examples
