// SPDX-License-Identifier: MIT
// What a run found out about itself: how much the keyframes covered, what was left alone, where the time went.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/vector_target.hpp>

#include <cstddef>
#include <map>
#include <mutex>
#include <set>
#include <vector>

namespace genrender {

/// Tokens of one feature resolution, summed over frames and steps.
struct coverage_count {
    std::size_t on_objects = 0; ///< tokens that show an object
    std::size_t covered = 0;    ///< of these, tokens for which some keyframe has a feature

    /// covered / on_objects; 0 without objects.
    double share() const {
        return on_objects > 0 ? static_cast<double>(covered) / static_cast<double>(on_objects) : 0.0;
    }
};

/// What a run tells when it has ended.
struct render_report {
    /// Coverage of the blend by feature resolution.
    std::map<grid_extents, coverage_count> coverage;
    /// Coverage of the consensus of clean estimates: latent cells on objects, and those that some source frame sees.
    coverage_count consensus;
    /// Frames that latent normalisation skipped in some step, for want of background.
    std::set<std::size_t> skipped_frames;
    /// Seconds by the clock on the wall in the denoiser, the attention that processors ask of it included.
    double denoiser_seconds = 0;
    /// Seconds in the rest of the library: compiling geometry, noise, keyframes, blend plans, consensus, normalisation.
    double library_seconds = 0;
    double consensus_seconds = 0; ///< of these in the consensus
    /// The vector target of the library's kernels when the run began.
    vector_target kernels = vector_target::baseline;
};

/// Adds to a report from any thread.
class report_writer {
public:
    /// Writes to `report`, which must outlive the writer.
    explicit report_writer(render_report& report) : report_(&report) {}

    /// Counts tokens of a frame at a feature resolution: those that show an object, and those that a plan covers.
    void add_coverage(grid_extents grid, std::size_t on_objects, std::size_t covered) {
        std::lock_guard const lock(mutex_);
        auto& count = report_->coverage[grid];
        count.on_objects += on_objects;
        count.covered += covered;
    }
    /// Counts latent cells of a frame for the consensus: those that show an object, and those that its plan covers.
    void add_consensus_coverage(std::size_t on_objects, std::size_t covered) {
        std::lock_guard const lock(mutex_);
        report_->consensus.on_objects += on_objects;
        report_->consensus.covered += covered;
    }
    /// Adds frames that normalisation skipped.
    void add_skipped(std::vector<std::size_t> const& frames) {
        std::lock_guard const lock(mutex_);
        report_->skipped_frames.insert(frames.begin(), frames.end());
    }
    /// Adds seconds in the denoiser and in the library.
    void add_seconds(double denoiser, double library) {
        std::lock_guard const lock(mutex_);
        report_->denoiser_seconds += denoiser;
        report_->library_seconds += library;
    }
    /// Adds seconds in the consensus, which are the library's.
    void add_consensus_seconds(double seconds) {
        std::lock_guard const lock(mutex_);
        report_->consensus_seconds += seconds;
        report_->library_seconds += seconds;
    }

private:
    std::mutex mutex_;
    render_report* report_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
