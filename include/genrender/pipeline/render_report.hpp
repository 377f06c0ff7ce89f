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

/// Filled in by a run; may be read when it has ended.
class render_report {
public:
    /// Coverage of the blend by feature resolution.
    std::map<grid_extents, coverage_count> const& coverage() const { return coverage_; }
    /// Frames that latent normalisation skipped in some step, for want of background.
    std::set<std::size_t> const& skipped_frames() const { return skipped_; }
    /// Seconds by the clock on the wall in the denoiser, the attention that processors ask of it included, and in the
    /// rest of the library: compiling geometry, noise, keyframes, blend plans, normalisation.
    double denoiser_seconds() const { return denoiser_seconds_; }
    double library_seconds() const { return library_seconds_; }
    /// The vector target of the library's kernels when the run began.
    genrender::vector_target vector_target() const { return vector_target_; }

    void add_coverage(grid_extents grid, std::size_t on_objects, std::size_t covered) {
        std::lock_guard const lock(mutex_);
        auto& count = coverage_[grid];
        count.on_objects += on_objects;
        count.covered += covered;
    }
    void add_skipped(std::vector<std::size_t> const& frames) {
        std::lock_guard const lock(mutex_);
        skipped_.insert(frames.begin(), frames.end());
    }
    void set_vector_target(genrender::vector_target target) { vector_target_ = target; }
    void add_seconds(double denoiser, double library) {
        std::lock_guard const lock(mutex_);
        denoiser_seconds_ += denoiser;
        library_seconds_ += library;
    }

private:
    std::mutex mutex_;
    std::map<grid_extents, coverage_count> coverage_;
    std::set<std::size_t> skipped_;
    genrender::vector_target vector_target_ = genrender::vector_target::baseline;
    double denoiser_seconds_ = 0;
    double library_seconds_ = 0;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
