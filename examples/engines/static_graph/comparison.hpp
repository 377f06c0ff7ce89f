// SPDX-License-Identifier: MIT
// One run of the small network for engines with static graphs, and the row of the table that an engine's frames make beside
// those of plain loops that are called back.
#pragma once

#include <genrender/core/tensor.hpp>
#include <genrender/maps/uv_maps.hpp>
#include <genrender/pipeline/render_report.hpp>
#include <genrender/pipeline/render_settings.hpp>

#include <functional>
#include <string>

namespace genrender::examples {

/// What a run is given.
struct graph_case {
    uv_maps UV;
    render_settings<float> settings = render_settings<float>::plain(); ///< what Python's clients have, too
};

/// The latents of an engine, and what its run told.
struct graph_frames {
    latents<float> z;
    render_report report;
};

/// Renders 7 frames by `run` and by the same network in plain loops over a host_attention_call, with several frames a call, a
/// shorter last one and steps without injection, and prints
///
///     engine | feature I/O | - | - | greatest difference | run s against the reference network | library outside the denoiser
///
/// The difference is a share of the range of the latents. Renders both once more with a length_correction of 1. Returns 0; 1
/// if a difference is above 1e-5, if an engine without injection or scales would pass too, or with a sentence if something
/// throws.
int compare_graphs(std::string const& engine, std::function<graph_frames(graph_case const&)> const& run);

} // namespace genrender::examples
