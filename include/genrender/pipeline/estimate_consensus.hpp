// SPDX-License-Identifier: MIT
// The stage between a method and latent normalisation: clean estimates of all frames agree along the surfaces.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/consensus.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>
#include <genrender/noise/background_noise.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/pipeline/sequence_passes.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

/// Whether the clean estimates of a step move towards a consensus along the surfaces.
template <class Real>
bool has_surface_consensus(render_settings<Real> const& settings, std::size_t step) {
    auto const& consensus = settings.consensus;
    return consensus.enabled && is_in_window(step, settings.steps, consensus.window_begin, consensus.window_end) &&
           consensus.strength(step) > 0;
}

/// Whether those of every step move towards one where no object is.
template <class Real>
bool has_background_consensus(render_settings<Real> const& settings) {
    return settings.consensus.enabled && settings.consensus.agrees_on_background &&
           settings.noise.background == background_noise::fixed;
}

/// Whether those of a step move towards either.
template <class Real>
bool has_consensus(render_settings<Real> const& settings, std::size_t step) {
    return has_surface_consensus(settings, step) || has_background_consensus(settings);
}

/// Whether those of any step move along the surfaces.
template <class Real>
bool uses_consensus(render_settings<Real> const& settings) {
    for (std::size_t step = 0; step < settings.steps; ++step) {
        if (has_surface_consensus(settings, step)) {
            return true;
        }
    }
    return false;
}

/// The source frames of a step's consensus, drawn as keyframes are and independently of these; none in a step without.
/// Throws as draw_keyframes does.
template <class Real>
std::vector<frame_index> consensus_sources(render_settings<Real> const& settings, std::size_t frames,
                                           std::size_t step) {
    if (!has_consensus(settings, step)) {
        return {};
    }
    auto sources = settings.consensus.sources;
    sources.count = std::min(sources.count, frames);
    return draw_keyframes(sources, frames, step, random_stream::consensus_sources);
}

/// For every cell of frame i that `background` [frames, height, width] marks, the cells at its place of the `sources` that
/// it marks too, with weights alike; other cells have no entry. Throws value_error if frame i does not exist.
template <class Real>
blend_plan<Real> background_plan(strided_view<std::uint8_t const, 3> background, std::span<frame_index const> sources,
                                 frame_index i) {
    require_value(i.value < background.extent(0), "background_plan", "i", i.value, "a frame of the background");
    auto const height = background.extent(1);
    auto const width = background.extent(2);
    blend_plan<Real> plan;
    plan.offsets.reserve(height * width + 1);
    for (std::size_t row = 0; row < height; ++row) {
        for (std::size_t column = 0; column < width; ++column) {
            auto const begin = plan.sources.size();
            for (std::size_t k = 0; k < sources.size() && background(i.value, row, column) != 0; ++k) {
                if (background(sources[k].value, row, column) != 0) {
                    plan.sources.push_back(static_cast<std::uint32_t>((k * height + row) * width + column));
                }
            }
            auto const seen = plan.sources.size() - begin;
            plan.weights.resize(plan.sources.size(), seen > 0 ? Real(1) / static_cast<Real>(seen) : Real(0));
            plan.offsets.push_back(static_cast<std::uint32_t>(plan.sources.size()));
        }
    }
    return plan;
}

/// What estimates of a run are told of its cells, each [frames, height, width] of the latents' grid, or nothing.
struct latent_cells {
    strided_view<std::uint8_t const, 3> shares{}; ///< that of cell_shares, for a consensus that fades at silhouettes
    strided_view<std::uint8_t const, 3> background{}; ///< that of open_background, for one that agrees there
};

/// Moves the clean estimates x0 [frames, channels, height, width] of a step towards their consensus, where the settings
/// have one: along the surfaces by plans of `map`, and where no object is to the mean at the place on the screen
/// (background_plan). `map` is that of the latents' grid and is read in steps with a consensus along the surfaces alone.
/// Without shares, or if the settings do not fade, covered cells move alike; without background it stays as it is. Each
/// frame reads copies of the sources, so frames run side by side and the result is the same with every loop. Returns how
/// many cells of each frame the sources cover, none without a consensus along the surfaces.
template <correspondence_map Map, class Real>
std::vector<std::size_t> reach_consensus(Map const* map, render_settings<Real> const& run,
                                         strided_view<std::type_identity_t<Real>, 4> x0, latent_cells const& cells,
                                         std::size_t step, any_loop const& loop) {
    auto const& settings = run.consensus;
    auto const frames = x0.extent(0);
    auto const on_surfaces = has_surface_consensus(run, step);
    auto const on_background = has_background_consensus(run) && cells.background.size() > 0;
    std::vector<std::size_t> covered(on_surfaces ? frames : 0, 0);
    if (!on_surfaces && !on_background) {
        return covered;
    }
    auto const sources = consensus_sources(run, frames, step);
    std::span<frame_index const> const from(sources);
    grid_extents const grid{x0.extent(2), x0.extent(3)};
    auto held = stack<Real, 3>::uninitialized({sources.size(), grid.size(), x0.extent(1)});
    loop(sources.size(),
         [&](std::size_t k) { gather_estimates(held.view()[k], in_view<Real, 3>(x0[sources[k].value])); });
    std::uint8_t const whole = 255;
    strided_view<std::uint8_t const, 2> const all_whole(&whole, {grid.height, grid.width}, {0, 0});
    auto const fades = settings.fades_at_silhouettes && cells.shares.size() > 0;
    auto const weights = settings.quality.at(step, run.steps);
    loop(frames, [&](std::size_t n) {
        frame_index const i{static_cast<std::uint32_t>(n)};
        if (on_surfaces) {
            auto const plan =
                make_blend_plan<Real>(*map, from, i, settings.first_fill_share, settings.average, weights);
            mix_consensus(x0[n], std::as_const(held).view(), plan.rows(), settings.strength(step), settings.most_gain,
                          fades ? cells.shares[n] : all_whole);
            covered[n] = plan.covered_count();
        }
        if (on_background) {
            // A gain would be another for each frame, as each sees another part.
            auto const plan = background_plan<Real>(cells.background, from, i);
            mix_consensus(x0[n], std::as_const(held).view(), plan.rows(), Real(1), Real(1), all_whole);
        }
    });
    return covered;
}

/// The same of a run, whose report is told coverage and seconds. Throws value_error if the run has no map of the latents'
/// grid and needs one.
template <denoiser Phi, correspondence_map Map>
void reach_consensus(sequence_run<Phi, Map> const& run, strided_view<typename Phi::real_type, 4> x0,
                     latent_cells const& cells, std::size_t step) {
    using clock = std::chrono::steady_clock;
    auto const start = clock::now();
    grid_extents const grid{x0.extent(2), x0.extent(3)};
    Map const* const map = has_surface_consensus(*run.settings, step) ? &run.maps->at(grid) : nullptr;
    auto const covered = reach_consensus(map, *run.settings, x0, cells, step, run.loop);
    for (std::uint32_t i = 0; i < covered.size(); ++i) {
        run.report->add_consensus_coverage(run.maps->tokens_on_objects(grid, {i}), covered[i]);
    }
    run.report->add_consensus_seconds(std::chrono::duration<double>(clock::now() - start).count());
}

} // namespace genrender

#include <genrender/core/end_header.inl>
