// SPDX-License-Identifier: MIT
// The stage between a method and latent normalisation: clean estimates of all frames agree along the surfaces.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/consensus.hpp>
#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/pipeline/sequence_passes.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// Whether the clean estimates of a step move towards a consensus.
template <class Real>
bool has_consensus(render_settings<Real> const& settings, std::size_t step) {
    auto const& consensus = settings.consensus;
    return consensus.enabled && is_in_window(step, settings.steps, consensus.window_begin, consensus.window_end) &&
           consensus.strength(step) > 0;
}

/// Whether those of any step do.
template <class Real>
bool uses_consensus(render_settings<Real> const& settings) {
    for (std::size_t step = 0; step < settings.steps; ++step) {
        if (has_consensus(settings, step)) {
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

/// Moves the clean estimates x0 [frames, channels, height, width] of a step towards their consensus, where the settings
/// have one, by plans of the map of the latents' grid. `shares` [frames, height, width] are those of cell_shares; without
/// any, or if the settings do not fade, covered cells move alike. Each frame reads copies of the sources, so frames run side
/// by side and the result is the same with every loop. Throws value_error if the run has no map of the latents' grid.
template <denoiser Phi, correspondence_map Map>
void reach_consensus(sequence_run<Phi, Map> const& run, strided_view<typename Phi::real_type, 4> x0,
                     strided_view<std::uint8_t const, 3> shares, std::size_t step) {
    using Real = typename Phi::real_type;
    using clock = std::chrono::steady_clock;
    auto const frames = x0.extent(0);
    auto const sources = consensus_sources(*run.settings, frames, step);
    if (sources.empty()) {
        return;
    }
    auto const start = clock::now();
    auto const& settings = run.settings->consensus;
    grid_extents const grid{x0.extent(2), x0.extent(3)};
    Map const& map = run.maps->at(grid);
    auto held = stack<Real, 3>::uninitialized({sources.size(), grid.size(), x0.extent(1)});
    run.loop(sources.size(),
             [&](std::size_t k) { gather_estimates(held.view()[k], in_view<Real, 3>(x0[sources[k].value])); });
    std::uint8_t const whole = 255;
    auto const fades = settings.fades_at_silhouettes && shares.size() > 0;
    run.loop(frames, [&](std::size_t n) {
        frame_index const i{static_cast<std::uint32_t>(n)};
        auto const plan = make_blend_plan<Real>(map, std::span<frame_index const>(sources), i,
                                                settings.first_fill_share, settings.average);
        auto const shares_of_frame =
            fades ? shares[n] : strided_view<std::uint8_t const, 2>(&whole, {grid.height, grid.width}, {0, 0});
        mix_consensus(x0[n], std::as_const(held).view(), plan.rows(), settings.strength(step), settings.most_gain,
                      shares_of_frame);
        run.report->add_consensus_coverage(run.maps->tokens_on_objects(grid, i), plan.covered_count());
    });
    run.report->add_consensus_seconds(std::chrono::duration<double>(clock::now() - start).count());
}

} // namespace genrender

#include <genrender/core/end_header.inl>
