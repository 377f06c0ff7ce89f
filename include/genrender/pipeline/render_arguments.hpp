// SPDX-License-Identifier: MIT
// What a run is given and what it gives.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/pipeline/checkpoint.hpp>
#include <genrender/pipeline/finished_step.hpp>
#include <genrender/pipeline/progress.hpp>
#include <genrender/pipeline/render_report.hpp>
#include <genrender/pipeline/render_settings.hpp>

#include <functional>
#include <string>

namespace genrender {

/// What a run needs besides a denoiser and maps, by name; all have defaults. `Map` is the
/// correspondence map of a feature resolution.
template <class Real, class Method, correspondence_map Map>
struct render_arguments {
    render_settings<Real> settings{}; ///< how it is rendered
    /// What is done in a step: a sequence_method.
    Method method{};
    /// Compiles the correspondence map of a feature grid; empty for the one that `settings.correspondence` chooses.
    std::function<Map(grid_extents)> make_map{};
    /// Told how far the run is; false ends it.
    progress_observer observer{};
    /// Runs what can be done at the same time; the frames are the same with every loop, bit for bit.
    any_loop loop{};
    /// Told of every step that is done: it can read z and the clean estimates, and make a checkpoint.
    std::function<void(finished_step<Real> const&)> after_step{};
    /// Where an earlier run was left, to go on to its frames, bit for bit; null begins anew.
    checkpoint<Real> const* resume = nullptr;
    /// Names what a denoiser does not tell of itself, weights, prompt and depth: a checkpoint of another name is refused.
    std::string model_key{};
};

/// What a run gives.
template <class Real>
struct render_result {
    /// z_0 [frames, channels, height, width], the clean latents of all frames, for the user's decoder. Of a run that was
    /// cancelled, z after its last whole step; before the first, the initial noise z_T.
    latents<Real> z;
    render_report report;      ///< what happened on the way, as far as the run came
    bool is_cancelled = false; ///< whether the observer ended the run
};

} // namespace genrender

#include <genrender/core/end_header.inl>
