// SPDX-License-Identifier: MIT
// [GR sec. 3] What the check of maps amounts to: its recommendations, and from which figure on there is one.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/inspection/map_check.hpp>
#include <genrender/inspection/recommendation.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace genrender {

/// From which figure on something is a finding. Shares in [0, 1].
struct recommendation_thresholds {
    double overlapping = 0.02;     ///< of an object's pixels; mirrored likewise
    double tiled = 0.02;           ///< of an object's pixels
    double degenerate = 0.05;      ///< of an object's pixels
    double blended_edges = 0.4;    ///< of silhouette pixels; curved surfaces have up to about 0.1 without antialiasing
    double seams = 0.05;           ///< of neighbouring pixels
    double tiny_tokens = 1;        ///< tokens of the finest grid that an object fills in a frame
    double coverage = 0.7;         ///< of tokens, below
    double hit_rate = 0.7;         ///< of partners, below
    double error = 1;              ///< in feature pixels, above
    double token_pixels_least = 4; ///< map pixels along a token, below
    double token_pixels_plenty = 32; ///< map pixels along a token of the finest grid, above
};

namespace detail {

/// Calls `recommend(kind, figure, frames)` for what one object calls for; `token_pixels` are in a token of the finest
/// grid.
template <class Recommend>
void recommend_on_object(object_check const& object, double token_pixels, recommendation_thresholds const& from,
                         Recommend const& recommend) {
    using enum recommendation_kind;
    auto const seen = static_cast<double>(object.frames.size());
    if (object.not_finite > 0) {
        recommend(not_finite, static_cast<double>(object.not_finite), object.not_finite_frames);
    }
    auto const a_frame = static_cast<double>(object.pixels) / std::max(seen, 1.0);
    if (a_frame < from.tiny_tokens * token_pixels) {
        recommend(tiny_object, a_frame, object.frames);
    }
    auto const pixels_a_value = [&](bool eight_bit) {
        double most = 0;
        for (auto const& levels : object.levels) {
            if (levels.is_quantised() && levels.is_eight_bit == eight_bit) {
                most = std::max(most, levels.quantum_in_pixels);
            }
        }
        return most;
    };
    auto const of_eight_bit = pixels_a_value(true);
    auto const of_others = pixels_a_value(false);
    auto const is_quantised = of_eight_bit > 0 || of_others > 0;
    if (is_quantised) {
        of_eight_bit > 0 ? recommend(eight_bit, of_eight_bit) : recommend(quantised, of_others);
    }
    auto const degenerate_share = share_of(object.without_footprint, object.looked_at);
    // Rounding hides the changes of coordinates; a pixel or a line of them has none.
    if (!is_quantised && degenerate_share > from.degenerate && a_frame >= 16) {
        recommend(degenerate, degenerate_share);
    }
    auto const blended = share_of(object.blended_edges, object.edges);
    if (blended > from.blended_edges && object.edges >= 16) {
        recommend(blended_edges, blended);
    }
    auto const mirrored_share = share_of(object.mirrored, object.asked);
    if (mirrored_share > from.overlapping) {
        recommend(mirrored, mirrored_share);
    }
    auto const overlapping_share = share_of(object.overlapping, object.asked);
    if (overlapping_share > from.overlapping) {
        recommend(overlapping, overlapping_share);
    }
    auto const tiled_share = share_of(object.tiled, object.pixels);
    if (tiled_share > from.tiled) {
        recommend(tiled, tiled_share);
    } else if (object.out_of_range > 0) {
        recommend(out_of_range, share_of(object.out_of_range, object.pixels));
    }
    auto const seam_share = share_of(object.seams, object.pairs);
    // Antialiased charts and rounded coordinates leap without a seam.
    if (!is_quantised && seam_share > from.seams) {
        recommend(many_seams, seam_share);
    }
}

} // namespace detail

/// Recommendations on the maps alone, those on frames first, then by object; `finest` is the finest feature grid.
/// Frames without background are one only if the run `needs_background`.
inline std::vector<recommendation> recommendations_on(map_check const& check, grid_extents finest,
                                                      recommendation_thresholds const& from = {},
                                                      bool needs_background = true) {
    using enum recommendation_kind;
    std::vector<recommendation> result;
    if (check.frames.empty() || check.grid.size() == 0) {
        result.push_back({.kind = no_frames});
        return result;
    }

    // Frames
    auto const recommend_frames = [&](recommendation_kind kind, auto const& is_such) {
        std::vector<frame_index> frames;
        for (std::uint32_t i = 0; i < check.frames.size(); ++i) {
            if (is_such(check.frames[i])) {
                frames.push_back({i});
            }
        }
        if (!frames.empty()) {
            auto const figure = static_cast<double>(frames.size());
            result.push_back({.kind = kind, .figure = figure, .frames = std::move(frames)});
        }
    };
    recommend_frames(nothing_visible, [](frame_check const& frame) { return frame.covered == 0; });
    recommend_frames(no_background,
                     [&](frame_check const& frame) { return needs_background && frame.covered == frame.pixels; });
    recommend_frames(identical_frames, [](frame_check const& frame) { return frame.same_as_previous; });
    if (check.frames.size() == 1) {
        result.push_back({.kind = one_frame, .figure = 1});
    }

    // Objects
    auto const token_pixels =
        finest.size() > 0 ? static_cast<double>(check.grid.size()) / static_cast<double>(finest.size()) : 0.0;
    for (auto const& object : check.objects) {
        detail::recommend_on_object(
            object, token_pixels, from,
            [&](recommendation_kind kind, double figure, std::vector<frame_index> frames = {}) {
                result.push_back(
                    {.kind = kind, .figure = figure, .object = object.object, .frames = std::move(frames)});
            });
    }
    return result;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
