// SPDX-License-Identifier: MIT
// [GR sec. 3] What is known before a run: the maps' defects, how well each feature grid finds its partners, what to do.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/chosen_correspondence.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/inspection/finite_maps.hpp>
#include <genrender/inspection/grid_check.hpp>
#include <genrender/inspection/map_check.hpp>
#include <genrender/inspection/map_recommendations.hpp>
#include <genrender/inspection/recommendation.hpp>
#include <genrender/inspection/screen_search.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>
#include <genrender/pipeline/generative_rendering.hpp>
#include <genrender/pipeline/render_settings.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// How closely a pre-flight looks.
struct preflight_settings {
    map_check_settings maps;              ///< how closely the maps themselves are looked at
    std::size_t steps = 3;                ///< evenly spread steps whose keyframes are drawn, at most
    std::size_t tokens = 1024;            ///< of a frame whose true partners are searched for, about
    recommendation_thresholds thresholds; ///< what counts as a finding
};

/// What a pre-flight found.
struct preflight_report {
    map_check maps;                                  ///< what the maps tell by themselves
    std::vector<grid_check> grids;                   ///< finest first
    std::vector<std::size_t> steps;                  ///< whose keyframes were drawn
    std::vector<std::vector<frame_index>> keyframes; ///< of each of these steps, in their order
    std::vector<recommendation> recommendations;     ///< on the maps, then on keyframes and grids
    std::size_t map_bytes = 0;                       ///< of coordinates, object numbers and coverage
    double map_seconds = 0;                          ///< by the clock on the wall, for the check of the maps
    double grid_seconds = 0; ///< and for compiling and measuring all grids, which a run compiles too

    /// Whether a run would take these maps and settings.
    bool allows_run() const {
        return std::none_of(recommendations.begin(), recommendations.end(),
                            [](recommendation const& one) { return one.forbids_run(); });
    }
};

namespace detail {

/// Whether latent normalisation takes place and leaves out frames without background.
template <class Real>
bool needs_background(render_settings<Real> const& settings) {
    auto const& by = settings.normalization;
    for (std::size_t step = 0; by.enabled && by.fallback == without_background::skip && step < settings.steps; ++step) {
        if (is_in_window(step, settings.steps, by.window_begin, by.window_end)) {
            return true;
        }
    }
    return false;
}

/// Draws the keyframes of some steps that have them, or notes why that cannot be.
template <class Real>
void draw_sample_steps(preflight_report& report, render_settings<Real> const& settings, std::size_t most) {
    std::vector<std::size_t> steps;
    for (std::size_t step = 0; step < settings.steps; ++step) {
        if (has_keyframes(settings, step)) {
            steps.push_back(step);
        }
    }
    try {
        for (auto const chosen : spread_frames(steps.size(), most)) {
            report.keyframes.push_back(
                draw_keyframes(settings.keyframes, report.maps.frames.size(), steps[chosen.value]));
            report.steps.push_back(steps[chosen.value]);
        }
    } catch (value_error const& refusal) {
        report.recommendations.push_back({.kind = recommendation_kind::keyframes_refused, .detail = refusal.what()});
    }
}

/// Compiles and measures every grid over maps that are finite.
template <canonical_maps Maps>
void check_grids(preflight_report& report, Maps const& maps, correspondence_settings const& settings,
                 std::size_t tokens, any_loop const& loop) {
    std::vector<frame_index> drawn;
    for (auto const& keyframes : report.keyframes) {
        drawn.insert(drawn.end(), keyframes.begin(), keyframes.end());
    }
    std::sort(drawn.begin(), drawn.end());
    drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
    std::vector<std::optional<screen_search<Maps>>> made(drawn.size());
    loop(drawn.size(), [&](std::size_t k) { made[k].emplace(maps, drawn[k]); });
    std::map<frame_index, screen_search<Maps>> searches;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
        searches.emplace(drawn[k], std::move(*made[k]));
    }
    auto cached = settings; // Every frame looks for tokens in all of them, one after the other.
    cached.footprint.cached_frames = std::max(cached.footprint.cached_frames, drawn.size());
    for (auto& check : report.grids) {
        try {
            chosen_correspondence<Maps::dimensions> const map(maps, check.grid, cached, loop);
            check = check_grid(map, maps, report.maps.looked_at, report.keyframes, searches, tokens, loop);
        } catch (value_error const& refusal) {
            check.refusal = refusal.what();
        }
    }
}

/// Adds what the measures of the grids call for.
inline void recommend_on_grids(preflight_report& report, correspondence_kind kind, std::optional<std::size_t> T,
                               recommendation_thresholds const& from) {
    using enum recommendation_kind;
    auto const texels = kind == correspondence_kind::texel_grid && T.has_value();
    for (auto const& check : report.grids) {
        auto const recommend = [&](recommendation_kind what, double figure) {
            report.recommendations.push_back({.kind = what, .figure = figure, .grid = check.grid});
        };
        if (check.refusal) {
            report.recommendations.push_back({.kind = grid_refused, .grid = check.grid, .detail = *check.refusal});
            continue;
        }
        auto const along = static_cast<double>(
            std::min(report.maps.grid.height / check.grid.height, report.maps.grid.width / check.grid.width));
        if (along < from.token_pixels_least) {
            recommend(maps_too_coarse, along);
        }
        if (&check == &report.grids.front() && along > from.token_pixels_plenty) {
            recommend(maps_finer_than_needed, along);
        }
        if (check.hit_rate() && *check.hit_rate() < from.hit_rate) {
            recommend(texels ? texture_too_fine : low_hit_rate, *check.hit_rate());
        }
        if (check.error() && *check.error() > from.error) {
            recommend(texels ? texture_too_coarse : great_error, *check.error());
        }
        if (check.coverage() && *check.coverage() < from.coverage) {
            recommend(low_coverage, *check.coverage());
        }
    }
}

} // namespace detail

/// Looks at maps as a run by `settings` at the feature `grids` would use them: hit rate, collisions, error and coverage
/// by the correspondence that the settings choose and the keyframes that its steps draw, and what the maps tell of
/// themselves. What cannot be measured, for bad contents, settings or grids, is said in a recommendation; nothing of
/// these throws. Does not depend on the threads of `loop` but for the seconds.
template <canonical_maps Maps, class Real>
preflight_report preflight(Maps const& maps, std::vector<grid_extents> grids, render_settings<Real> const& settings,
                           any_loop const& loop = {}, preflight_settings const& how = {}) {
    using clock = std::chrono::steady_clock;
    auto const seconds_since = [](clock::time_point start) {
        return std::chrono::duration<double>(clock::now() - start).count();
    };
    preflight_report report;
    auto const start = clock::now();
    report.maps = check_maps(maps, how.maps, loop);
    report.map_bytes = maps.frame_count() * maps.grid().size() *
                       (Maps::dimensions * sizeof(float) + sizeof(std::uint32_t) + sizeof(std::uint8_t));
    report.map_seconds = seconds_since(start);
    std::sort(grids.begin(), grids.end(), [](auto const& a, auto const& b) { return a.size() > b.size(); });
    report.recommendations = recommendations_on(report.maps, grids.empty() ? grid_extents{} : grids.front(),
                                                how.thresholds, detail::needs_background(settings));
    if (report.maps.frames.empty() || maps.grid().size() == 0) {
        return report;
    }

    auto const grids_start = clock::now();
    detail::draw_sample_steps(report, settings, how.steps);
    for (auto const grid : grids) {
        report.grids.emplace_back().grid = grid;
    }
    auto const& by = settings.correspondence;
    // Texels are of UV maps alone and refuse, with a sentence, what is not finite; trees of footprints must not see it.
    if (report.maps.not_finite() == 0 || by.kind == correspondence_kind::texel_grid) {
        detail::check_grids(report, maps, by, how.tokens, loop);
    } else {
        detail::check_grids(report, finite_maps<Maps>(maps), by, how.tokens, loop);
    }
    detail::recommend_on_grids(report, by.kind, by.texels.T, how.thresholds);
    report.grid_seconds = seconds_since(grids_start);
    return report;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
