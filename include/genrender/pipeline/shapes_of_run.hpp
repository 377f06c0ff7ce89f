// SPDX-License-Identifier: MIT
// The shapes of a run from its settings, method and compiled maps.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/row_bound.hpp>
#include <genrender/correspondence/correspondence_set.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/pipeline/sequence_method.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ranges>

namespace genrender {

/// A sequence_method that says what of a denoiser it uses, an optional capability: of another one a denoiser is told
/// that it may use everything.
///
/// expression                       | type | meaning
/// ---------------------------------|------|--------------------------------------------------------------------------
/// `method.shape(settings, shapes)` | any  | changes the run_shapes of a run of these settings to what the method asks
///                                  |      | for at most; filled in already are members that do not depend on it, and
///                                  |      | `row_width` for plans of as many tokens a keyframe as the maps know
template <class Method, class Real>
concept shaping_method = requires(Method const& method, render_settings<Real> const& settings, run_shapes& shapes) {
    method.shape(settings, shapes);
};

/// The shapes of a run of `frames` frames by a method with a denoiser. `maps` are those of all feature grids that take
/// part. Throws value_error if a step's keyframes cannot be drawn.
template <denoiser Phi, class Map, class Real, class Method>
run_shapes shapes_of_run(Phi const& phi, render_settings<Real> const& settings, std::size_t frames,
                         correspondence_set<Map> const& maps, Method const& method) {
    run_shapes shapes;
    shapes.frames = frames;
    shapes.has_plain_steps = false;
    for (std::size_t step = 0; step < settings.steps; ++step) {
        auto const count = method.keyframes(settings, frames, step).size();
        shapes.keyframes = std::max(shapes.keyframes, count);
        shapes.has_plain_steps = shapes.has_plain_steps || count == 0;
    }
    shapes.frames_per_call = stack_size(settings, frames);
    auto const rest = frames % shapes.frames_per_call;
    shapes.last_call = rest == 0 || settings.fills_last_call ? shapes.frames_per_call : rest;
    shapes.calls_at_once = settings.calls_at_once;
    auto const& sites = phi.sites();
    for (std::uint32_t site = 0; site < std::ranges::size(sites); ++site) {
        for (std::uint32_t branch = 0; branch < phi.branches(); ++branch) {
            if (settings.layers(sites[site], branch)) {
                shapes.places.push_back({{site}, branch});
            }
        }
    }
    for (auto const& [grid, map] : maps) {
        shapes.row_width = std::max(shapes.row_width, max_row_width(map, shapes.keyframes));
    }
    shapes.storage = settings.keyframe_storage;
    shapes.scales_logits = settings.injection.length_correction > 0;
    shapes.counts_keys = settings.injection.counts_points;
    shapes.keeps_variance = settings.injection.variance.target != variance_target::none;
    if constexpr (shaping_method<Method, Real>) {
        method.shape(settings, shapes);
    }
    return shapes;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
