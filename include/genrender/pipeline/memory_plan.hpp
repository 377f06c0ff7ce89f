// SPDX-License-Identifier: MIT
// What a run will take, said before it starts: bytes by what holds them, FLOPs and bytes moved by what moves them.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/pipeline/generative_rendering.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/pipeline/run_description.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

namespace genrender {

/// Bytes that a run holds at its peak. Those of the first group grow with the number of frames, the others do not.
struct planned_bytes {
    std::size_t maps = 0;           ///< UV or rest positions, object and coverage: the caller's, not in `peak`
    std::size_t latents = 0;        ///< z, clean estimates and what the sampler remembers
    std::size_t background = 0;     ///< mask of latent normalisation
    std::size_t correspondence = 0; ///< compiled maps of all feature grids

    std::size_t bank = 0;             ///< K_KF, V_KF and F_KF of all places that take part
    std::size_t residuals = 0;        ///< what the denoiser reuses of keyframes
    std::size_t keyframe_latents = 0; ///< z_KF and its estimate
    std::size_t blend_plans = 0;      ///< of the calls under way
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
    double noise_values = 0;          ///< values of N(0, 1) in the initial latents
    double normalized_bytes = 0;      ///< read and written by latent normalisation

    /// How many times the attention of denoising every frame by itself; 1 without keyframes.
    double attention_ratio() const { return plain_attention_flops > 0 ? attention_flops / plain_attention_flops : 1.0; }
};

/// What a run of Alg. 1 will take.
struct memory_plan {
    planned_bytes bytes;
    planned_work work;
};

namespace detail {

/// Elements that a vector has room for after `count` elements were appended one by one.
inline std::size_t grown_capacity(std::size_t count) { return count == 0 ? 0 : std::bit_ceil(count); }

/// Bytes of a footprint_map of D coordinates, about: per token a point, per kept pixel a sample and its share of the
/// search structures.
template <std::size_t D>
std::size_t footprint_bytes(run_description const& run, grid_extents grid) {
    struct sample { // as footprint_map keeps them
        token_index token;
        float purity;
        std::array<float, D> place;
        std::optional<surface_footprint<D>> footprint;
        double density;
    };
    using point_type = std::optional<typename footprint_map<D>::point_type>;
    constexpr std::size_t kept = 16;                                       // pixels a cell
    constexpr std::size_t row = D > 2 ? 4 * (D + 9 + 1) : 4 * (D + 4 + 1); // of sample_grid, for a pixel
    auto const cell = std::max<std::size_t>(1, run.map_grid.size() / std::max<std::size_t>(1, grid.size()));
    auto const bytes_of = [&](std::size_t pixels) {
        auto const n = pixels * std::min(kept, cell) / cell;
        auto const nodes = (12 * n + 8191) / 8192 * 8208; // of sample_tree, in blocks
        auto const bins = 3 * n + 64;                     // of sample_grid, 5 bytes each
        return grown_capacity(n) * (sizeof(sample) + sizeof(sample::place)) + 4 * n + nodes + (n + 16) * row + 5 * bins;
    };
    auto bytes = run.frames * grid.size() * sizeof(point_type);
    for (auto const pixels : run.surface_pixels) {
        bytes += bytes_of(pixels);
    }
    return run.surface_pixels.empty() ? bytes + run.frames * bytes_of(run.map_grid.size()) : bytes;
}

/// Bytes of a texel_grid, at most: what tokens read, and per frame a bit for every texel that some token reads.
inline std::size_t texel_bytes(run_description const& run, grid_extents grid) {
    constexpr std::size_t entry = 20; // of a texel that a frame shows
    auto const tokens = run.frames * grid.size();
    return tokens * sizeof(std::uint32_t) + run.frames * (tokens / 64 + 1) * 12 +
           grown_capacity(grid.size()) * entry * run.frames;
}

template <class Real>
std::size_t correspondence_bytes(run_description const& run, render_settings<Real> const& settings, grid_extents grid) {
    if (settings.correspondence.kind == correspondence_kind::texel_grid) {
        return texel_bytes(run, grid);
    }
    return run.map_dimensions == 3 ? footprint_bytes<3>(run, grid) : footprint_bytes<2>(run, grid);
}

/// Stacks of the latents' size that live while D is evaluated and between evaluations.
struct latent_stacks {
    std::size_t evaluating;
    std::size_t stepping;
};

inline latent_stacks stacks_of(sampler method) {
    switch (method) {
    case sampler::heun:
        return {4, 7};
    case sampler::dpmpp_2m:
        return {3, 5};
    default:
        return {2, 3};
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
    for (std::size_t step = 0; step < settings.steps; ++step) {
        auto const of_step = settings.method == sampler::heun && step > 0 ? std::size_t{2} : std::size_t{1};
        auto const drawn = method.keyframes(settings, run.frames, step).size();
        evaluations += of_step;
        with_keyframes += drawn > 0 ? of_step : 0;
        m = std::max(m, drawn);
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
            auto const blocks = takes_part && settings.pre_attention ? keyframes : 0;
            auto const left_out = settings.keeps_own_copy ? 0 : blocks; // a block for each keyframe
            work.attention_flops += plain_evaluations * frames * own +  // every frame to itself
                                    injected_evaluations * (frames * blocks - left_out) * own +     // and to keyframes
                                    injected_evaluations * keyframes * std::max(1.0, blocks) * own; // among themselves
            if (!takes_part) {
                continue;
            }
            largest_recorded = std::max(largest_recorded, elements);
            bytes.bank += 3 * m * elements * feature_bytes<Real>(settings.feature_storage);
            if (settings.post_attention) {
                grids.insert(site.grid);
                work.mixed_bytes +=
                    injected_evaluations * frames * N * C *
                    static_cast<double>(2 * sizeof(Real) + m * feature_bytes<Real>(settings.feature_storage));
            }
        }
    }

    // What grows with the frames.
    auto const latent_bytes = run.latent_channels * run.latent_grid.size() * sizeof(Real);
    auto const stacks = detail::stacks_of(settings.method);
    bytes.maps = run.frames * run.map_grid.size() * (run.map_dimensions * sizeof(float) + 5);
    bytes.background = run.frames * run.latent_grid.size();
    for (auto const& grid : grids) {
        bytes.correspondence += detail::correspondence_bytes(run, settings, grid);
    }

    // What does not: the keyframes' features and the calls under way.
    auto const of_frame = std::max(run.network_bytes, 5 * largest_site * sizeof(Real)); // f, Q, K, V, F
    auto const calls = std::min(std::max<std::size_t>(run.calls_at_once, 1), run.frames);
    auto const at_once = std::min(calls * std::min(settings.frames_per_call, run.frames), run.frames);
    bytes.keyframe_latents = 2 * m * latent_bytes;
    bytes.residuals = settings.reuses_keyframes ? m * run.residual_bytes : 0;
    for (auto const& grid : grids) {
        auto const entries = detail::grown_capacity(grid.size() * m);
        bytes.blend_plans +=
            at_once * ((grid.size() + 1) * sizeof(std::uint32_t) + entries * (sizeof(std::uint32_t) + sizeof(Real)));
    }
    // Recorded features of the site that is running are in the bank and in the call; count them once.
    auto const counted_twice =
        settings.feature_storage == feature_storage::same ? 3 * m * largest_recorded * sizeof(Real) : 0;
    auto const keyframe_call = run.call_bytes + m * of_frame - std::min(counted_twice, m * of_frame);
    auto const frames_call = calls * run.call_bytes + at_once * of_frame;
    auto const recording = stacks.evaluating * run.frames * latent_bytes + bytes.keyframe_latents + keyframe_call;
    auto const injecting = stacks.evaluating * run.frames * latent_bytes + bytes.blend_plans + frames_call;
    auto const stepping = stacks.stepping * run.frames * latent_bytes;
    auto const features = bytes.bank + bytes.residuals;
    bytes.peak = bytes.background + bytes.correspondence +
                 std::max(stepping, features + std::max(m > 0 ? recording : 0, injecting));
    bytes.network = std::max(keyframe_call, frames_call);
    auto const is_stepping = stepping > features + std::max(m > 0 ? recording : 0, injecting);
    bytes.latents = (is_stepping ? stacks.stepping : stacks.evaluating) * run.frames * latent_bytes;

    work.noise_values = frames * static_cast<double>(run.latent_channels * run.latent_grid.size());
    if (settings.normalization.enabled) { // statistics read, values read and written
        work.normalized_bytes = plain_evaluations * 3 * frames * static_cast<double>(latent_bytes);
    }
    return plan;
}

} // namespace genrender
