// SPDX-License-Identifier: MIT
// What decides the cost of a run beside its settings: the denoiser's sites and grids, frames, maps, threads.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/core/index.hpp>
#include <genrender/keyframes/stoppable_denoiser.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace genrender {

/// A run before it starts. `describe_run` fills it in from a denoiser and maps; a run of which nothing exists yet is
/// described by hand.
struct run_description {
    std::size_t frames = 0;            ///< of the animation
    std::size_t latent_channels = 0;   ///< of z
    grid_extents latent_grid;          ///< height and width of z
    std::size_t branches = 1;          ///< guidance branches
    std::vector<attention_site> sites; ///< self-attention modules of the denoiser
    grid_extents map_grid;             ///< height and width of the maps
    std::size_t map_dimensions = 2;    ///< canonical coordinates of a map's pixel
    /// Pixels that each object fills in each frame, one entry an object and frame that shows it. Empty: one object that
    /// fills every frame, the most that there can be.
    std::vector<std::size_t> surface_pixels;
    std::size_t calls_at_once = 1; ///< threads of the run's loop
    /// The most memory that a call of the denoiser takes: for each frame of its stack, features included, and besides.
    /// None if unknown: then the features of the largest site alone are counted.
    std::optional<std::size_t> network_bytes;
    std::optional<std::size_t> call_bytes; ///< see network_bytes
    /// What a denoiser keeps of a keyframe to reuse it (residual_lender), a frame; none for one that does not.
    std::optional<std::size_t> residual_bytes;
};

/// The description of a run of a denoiser on maps whose loop has so many threads. Reads the maps once.
template <denoiser Phi, canonical_maps Maps>
run_description describe_run(Phi const& phi, Maps const& maps, std::size_t calls_at_once = 1) {
    run_description run;
    run.frames = maps.frame_count();
    run.latent_channels = phi.latent_channels();
    run.latent_grid = phi.latent_grid();
    run.branches = phi.branches();
    auto const& sites = phi.sites();
    run.sites.assign(std::ranges::begin(sites), std::ranges::end(sites));
    run.map_grid = maps.grid();
    run.map_dimensions = Maps::dimensions;
    run.calls_at_once = calls_at_once;
    for (std::uint32_t i = 0; i < run.frames; ++i) {
        std::map<object_index, std::size_t> pixels;
        for (std::uint32_t row = 0; row < run.map_grid.height; ++row) {
            for (std::uint32_t column = 0; column < run.map_grid.width; ++column) {
                if (maps.is_covered({i}, {row, column})) {
                    ++pixels[maps.object_at({i}, {row, column})];
                }
            }
        }
        if (pixels.empty()) {
            pixels[{}] = 0; // An entry all the same: no entries at all mean full frames.
        }
        for (auto const& [object, count] : pixels) {
            run.surface_pixels.push_back(count);
        }
    }
    if constexpr (residual_lender<Phi>) {
        run.residual_bytes = phi.residual_bytes();
    }
    return run;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
