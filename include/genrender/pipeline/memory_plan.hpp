// SPDX-License-Identifier: MIT
// What a run will take, said before it starts: bytes by what holds them, FLOPs and bytes moved by what moves them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/pipeline/estimate_consensus.hpp>
#include <genrender/pipeline/generative_rendering.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/pipeline/run_description.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <set>

namespace genrender {

/// Bytes that a run holds at its peak. Those of the first group grow with the number of frames, the others do not, but
/// for `matching` up to its limit.
struct planned_bytes {
    std::size_t maps = 0;           ///< UV or rest positions, object and coverage: the caller's, not in `peak`
    std::size_t latents = 0;        ///< z, clean estimates and what the sampler remembers
    std::size_t background = 0;     ///< masks of latent normalisation and of a consensus, and its shares of cells
    std::size_t correspondence = 0; ///< which pixel or texel stands for each token, at all resolutions

    std::size_t bank = 0;             ///< K_KF, V_KF and F_KF of all places that take part
    std::size_t residuals = 0;        ///< what the denoiser reuses of keyframes
    std::size_t keyframe_latents = 0; ///< z_KF and its estimate
    std::size_t matching = 0;         ///< the caches that find tokens fast, see footprint_map_settings
    std::size_t blend_plans = 0;      ///< of the calls under way
    std::size_t consensus = 0;        ///< estimates of its sources, plans and averages of the frames under way
    std::size_t network = 0;          ///< in the calls under way, queries, keys and values included

    std::size_t peak = 0; ///< most that is held at once; less than the sum, for not all is alive at the same time

    /// Bytes of the library and the maps that each further frame adds.
    std::size_t of_frames() const { return maps + latents + background + correspondence; }
};

/// What a run computes in attention and around it, summed over all steps.
struct planned_work {
    std::size_t denoised_frames = 0;  ///< frames given to the denoiser, keyframes counted anew in each step
    double attention_flops = 0;       ///< 4 N N_kv C of every site, frame and branch
    double plain_attention_flops = 0; ///< the same if every frame were denoised by itself
    double projection_flops = 0;      ///< the network's own W^Q f, W^K f and W^V f, 6 N C^2
    double mixed_bytes = 0;           ///< read and written by eq. 6, at most
    double consensus_bytes = 0;       ///< read and written by the consensus of clean estimates, at most
    double consensus_matches = 0;     ///< latent cells that it looks up in source frames
    double noise_values = 0;          ///< values of N(0, 1) in the initial latents
    double normalized_bytes = 0;      ///< read and written by latent normalisation

    /// How many times the attention of denoising every frame by itself; 1 without keyframes.
    double attention_ratio() const { return plain_attention_flops > 0 ? attention_flops / plain_attention_flops : 1.0; }
};

/// What a run of Alg. 1 will take.
struct memory_plan {
    planned_bytes bytes; ///< what it holds
    planned_work work;   ///< what it computes
};

namespace detail {

/// Elements that a vector has room for after `count` elements were appended one by one.
inline std::size_t grown_capacity(std::size_t count) { return count == 0 ? 0 : std::bit_ceil(count); }

/// Bytes of what a footprint_map needs to find tokens, about.
struct matching_bytes {
    std::size_t cached = 0; ///< samples of the frames that it was asked for last, matches of all frames with all that
                            ///< ever are keyframes
    std::size_t making = 0; ///< for a moment, while a thread makes the samples of a frame
};

template <std::size_t D>
matching_bytes matching_of(run_description const& run, footprint_map_settings const& settings, grid_extents grid,
                           std::size_t keyframes, std::size_t ever_keyframes) {
    auto const cell = std::max<std::size_t>(1, run.map_grid.size() / std::max<std::size_t>(1, grid.size()));
    auto pixels = run.surface_pixels;
    if (pixels.empty()) {
        pixels.assign(run.frames, run.map_grid.size());
    }
    matching_bytes bytes;
    for (auto const count : pixels) {
        bytes.cached += frame_samples<D>::expected_bytes(count, cell);
        bytes.making += frame_samples<D>::making_bytes(count, cell);
    }
    auto const cached_frames = std::min(std::max(settings.cached_frames, keyframes), ever_keyframes);
    bytes.cached = bytes.cached / run.frames * cached_frames +
                   match_cache::expected_bytes(run.frames * ever_keyframes, grid.size(), settings.match_cache_bytes);
    bytes.making /= run.frames;
    return bytes;
}

/// Bytes of a texel_grid, at most: what tokens read, and per frame a bit for every texel that some token reads.
inline std::size_t texel_bytes(run_description const& run, grid_extents grid) {
    constexpr std::size_t entry = 20; // of a texel that a frame shows
    auto const tokens = run.frames * grid.size();
    return tokens * sizeof(std::uint32_t) + run.frames * (tokens / 64 + 1) * 12 +
           grown_capacity(grid.size()) * entry * run.frames;
}

/// Stacks of the latents' size that live while D is evaluated, that of the result included; updates between evaluations
/// add none.
inline std::size_t latent_stacks(sampler_kind sampler) {
    switch (sampler) {
    case sampler_kind::heun:
        return 5;
    case sampler_kind::dpmpp_2m:
        return 4;
    default:
        return 3;
    }
}

} // namespace detail

/// What a run of these settings takes in the library: exact in its latents, features and FLOPs of attention, close in
/// what depends on what the maps show. Values of the denoiser's own are those of the description. Throws value_error if
/// a step's keyframes cannot be drawn.
template <class Real>
memory_plan plan_memory(run_description const& run, render_settings<Real> const& settings) {
    memory_plan plan;
    auto& bytes = plan.bytes;
    auto& work = plan.work;
    generative_rendering const method;

    // Count evaluations, and the keyframes in them.
    std::size_t evaluations = 0;
    std::size_t with_keyframes = 0;
    std::size_t m = 0;
    std::set<frame_index> ever_keyframes;
    std::size_t consensus_evaluations = 0;
    std::size_t surface_evaluations = 0; // of these, with a consensus along the surfaces
    std::size_t K = 0;                   // source frames of a consensus
    std::set<frame_index> ever_sources;
    for (std::size_t step = 0; step < settings.steps; ++step) {
        auto const of_step = evaluations_at(settings.sampler, step);
        auto const drawn = method.keyframes(settings, run.frames, step);
        evaluations += of_step;
        with_keyframes += drawn.empty() ? 0 : of_step;
        m = std::max(m, drawn.size());
        ever_keyframes.insert(drawn.begin(), drawn.end());
        auto const sources = consensus_sources(settings, run.frames, step);
        consensus_evaluations += sources.empty() ? 0 : of_step;
        surface_evaluations += has_surface_consensus(settings, step) ? of_step : 0;
        K = std::max(K, sources.size());
        ever_sources.insert(sources.begin(), sources.end());
    }
    work.denoised_frames = evaluations * run.frames + with_keyframes * m;

    // Sites: features in the bank, attention, blending.
    auto const frames = static_cast<double>(run.frames);
    auto const keyframes = static_cast<double>(m);
    auto const plain_evaluations = static_cast<double>(evaluations);
    auto const injected_evaluations = static_cast<double>(with_keyframes);
    std::size_t largest_site = 0;
    std::size_t largest_recorded = 0;
    std::set<grid_extents> grids;
    for (auto const& site : run.sites) {
        auto const elements = site.grid.size() * site.channels;
        largest_site = std::max(largest_site, elements);
        auto const N = static_cast<double>(site.grid.size());
        auto const C = static_cast<double>(site.channels);
        for (std::uint32_t branch = 0; branch < run.branches; ++branch) {
            auto const own = 4 * N * N * C;
            work.plain_attention_flops += plain_evaluations * frames * own;
            work.projection_flops += static_cast<double>(work.denoised_frames) * 6 * N * C * C;
            auto const takes_part = m > 0 && settings.layers(site, branch);
            auto const blocks = takes_part && settings.injection.pre_attention ? keyframes : 0;
            auto const left_out = settings.injection.keeps_own_copy ? 0 : blocks; // a block for each keyframe
            work.attention_flops += plain_evaluations * frames * own +            // every frame to itself
                                    injected_evaluations * (frames * blocks - left_out) * own +     // and to keyframes
                                    injected_evaluations * keyframes * std::max(1.0, blocks) * own; // among themselves
            if (!takes_part) {
                continue;
            }
            largest_recorded = std::max(largest_recorded, elements);
            bytes.bank += 3 * m * elements * feature_bytes<Real>(settings.keyframe_storage);
            if (makes_plans(settings.injection)) {
                grids.insert(site.grid);
            }
            if (settings.injection.post_attention) {
                work.mixed_bytes +=
                    (site.grid == run.latent_grid && settings.latents_grid_alpha == 0 ? 0 : 1) * injected_evaluations *
                    frames * N * C *
                    static_cast<double>(2 * sizeof(Real) + m * feature_bytes<Real>(settings.keyframe_storage));
            }
        }
    }

    // What grows with the frames.
    auto const latent_bytes = run.latent_channels * run.latent_grid.size() * sizeof(Real);
    bytes.latents = detail::latent_stacks(settings.sampler) * run.frames * latent_bytes;
    bytes.maps = run.frames * run.map_grid.size() * (run.map_dimensions * sizeof(float) + 5);
    auto const has_shares = surface_evaluations > 0 && settings.consensus.fades_at_silhouettes;
    auto const masks = 1 + (has_shares ? 1U : 0U) + (has_background_consensus(settings) ? 1U : 0U);
    bytes.background = masks * run.frames * run.latent_grid.size();
    auto const by_texels = settings.correspondence.kind == correspondence_kind::texel_grid;
    auto all_grids = grids;
    if (surface_evaluations > 0) {
        all_grids.insert(run.latent_grid);
    }
    for (auto const& grid : all_grids) {
        bytes.correspondence +=
            by_texels ? detail::texel_bytes(run, grid) : footprint_map<2>::expected_bytes(run.frames, grid.size());
    }

    // What does not: the keyframes' features and the calls under way.
    auto const of_frame = std::max(run.network_bytes.value_or(0), 5 * largest_site * sizeof(Real)); // f, Q, K, V, F
    auto calls = std::min(std::max<std::size_t>(run.calls_at_once, 1), run.frames);
    calls = settings.calls_at_once > 0 ? std::min(calls, settings.calls_at_once) : calls;
    auto const of_calls = calls * stack_size(settings, run.frames);
    auto const at_once = settings.fills_last_call ? of_calls : std::min(of_calls, run.frames);
    bytes.keyframe_latents = 2 * m * latent_bytes;
    bytes.residuals = settings.reuses_keyframes ? m * run.residual_bytes.value_or(0) : 0;
    std::size_t making = 0;
    auto const of_keyframes = settings.injection.pre_attention && settings.injection.counts_points ? m : 0;
    auto const plan_bytes = [&](grid_extents grid, std::size_t frames_of_plan) {
        auto const most = grid.size() * frames_of_plan;
        auto const entries = by_texels ? detail::grown_capacity(most) : most + 1;
        return (grid.size() + 1) * sizeof(std::uint32_t) + entries * (sizeof(std::uint32_t) + sizeof(Real));
    };
    for (auto const& grid : all_grids) {
        auto const has_plans = grids.contains(grid);
        auto const has_sources = surface_evaluations > 0 && grid == run.latent_grid;
        if (!by_texels) { // One map, for both if both have the grid.
            auto ever = has_plans ? ever_keyframes : std::set<frame_index>{};
            ever.insert(ever_sources.begin(), has_sources ? ever_sources.end() : ever_sources.begin());
            auto const matching_of = run.map_dimensions == 3 ? detail::matching_of<3> : detail::matching_of<2>;
            auto const matching = matching_of(run, settings.correspondence.footprint, grid,
                                              std::max(has_plans ? m : 0, has_sources ? K : 0), ever.size());
            bytes.matching += matching.cached;
            making = std::max(making, matching.making);
        }
        bytes.blend_plans += has_plans ? (at_once + of_keyframes) * plan_bytes(grid, m) : 0;
    }
    if (K > 0) {
        auto const lanes = std::min(std::max<std::size_t>(run.calls_at_once, 1), run.frames);
        auto const cells = run.latent_grid.size();
        auto const matches = K * token_matches::bytes_of(cells); // which a full cache does not keep
        auto const is_kept = run.frames * ever_sources.size() * token_matches::bytes_of(cells) <=
                             settings.correspondence.footprint.match_cache_bytes;
        bytes.consensus =
            K * latent_bytes + lanes * (plan_bytes(run.latent_grid, K) + latent_bytes +
                                        (by_texels || is_kept || surface_evaluations == 0 ? 0 : matches) + making);
    }
    // Recorded features of the site that is running are counted in the bank. If they are copies of 16 bits, these are
    // made after attention, when a call holds less by about as much.
    auto const counted_twice = 3 * m * largest_recorded * sizeof(Real);
    auto const keyframe_call = run.call_bytes.value_or(0) + m * of_frame - std::min(counted_twice, m * of_frame);
    auto const frames_call = calls * run.call_bytes.value_or(0) + at_once * of_frame;
    bytes.network = std::max(keyframe_call, frames_call);
    auto const recording = m > 0 ? bytes.keyframe_latents + keyframe_call : 0;
    auto const injecting = bytes.blend_plans + std::max(frames_call, calls * making);
    auto const in_method = bytes.bank + bytes.residuals + std::max(recording, injecting);
    bytes.peak =
        bytes.latents + bytes.background + bytes.correspondence + bytes.matching + std::max(in_method, bytes.consensus);

    work.noise_values = frames * static_cast<double>(run.latent_channels * run.latent_grid.size());
    // Sources are copied; a frame's averages read them and are written and read twice, for statistics and to move x0.
    work.consensus_bytes = static_cast<double>(consensus_evaluations) * static_cast<double>(latent_bytes) *
                           (2 * static_cast<double>(K) + frames * (2 * static_cast<double>(K) + 5));
    work.consensus_matches = static_cast<double>(surface_evaluations) * frames * static_cast<double>(K) *
                             static_cast<double>(run.latent_grid.size());
    if (settings.normalization.enabled) { // statistics read, values read and written
        work.normalized_bytes = plain_evaluations * 3 * frames * static_cast<double>(latent_bytes);
    }
    return plan;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
