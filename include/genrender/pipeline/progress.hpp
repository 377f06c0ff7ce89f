// SPDX-License-Identifier: MIT
// How far a run is and what is left of it, told to an observer that can end it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

namespace genrender {

/// Part of a step.
enum class render_pass : std::uint8_t {
    keyframes, ///< the keyframes' features are being recorded
    frames     ///< all frames are being denoised
};

/// State of a run, after the work it names was done.
struct progress {
    std::size_t step = 0;                      ///< diffusion step, from 0
    std::size_t steps = 0;                     ///< T
    render_pass pass = render_pass::keyframes; ///< what is being done
    std::size_t frames_done = 0;               ///< of this pass
    std::size_t frames = 0;                    ///< in this pass
    double elapsed_seconds = 0;                ///< since the run began
    double remaining_seconds = 0;              ///< estimate: what is left takes as long per frame as what was done
};

/// Called from one thread at a time after each call of the denoiser; returning false ends the run with `cancelled`, and
/// it is not called again.
using progress_observer = std::function<bool(progress const&)>;

/// Counts the denoised frames of a run and tells the observer.
class progress_meter {
public:
    /// A run of `steps` steps that denoises `total` frames in all, keyframes and repeats included.
    progress_meter(std::size_t steps, std::size_t total, progress_observer observer)
        : steps_(steps), total_(total), observer_(std::move(observer)), start_(clock::now()) {}

    /// Begins a pass over `frames` frames.
    void begin(std::size_t step, render_pass pass, std::size_t frames) {
        state_ = {step, steps_, pass, 0, frames, 0, 0};
    }

    /// Counts finished frames. Throws cancelled if the observer asks for it. May be called from several threads.
    void add(std::size_t frames) {
        std::lock_guard const lock(mutex_);
        done_ += frames;
        state_.frames_done += frames;
        state_.elapsed_seconds = std::chrono::duration<double>(clock::now() - start_).count();
        auto const left = done_ < total_ ? static_cast<double>(total_ - done_) : 0.0;
        state_.remaining_seconds = done_ > 0 ? state_.elapsed_seconds / static_cast<double>(done_) * left : 0.0;
        is_cancelled_ = is_cancelled_ || (observer_ && !observer_(state_));
        if (is_cancelled_) {
            throw cancelled("render: cancelled by its observer in step " + std::to_string(state_.step + 1) + " of " +
                            std::to_string(steps_));
        }
    }

private:
    using clock = std::chrono::steady_clock;
    std::size_t steps_;
    std::size_t total_;
    std::size_t done_ = 0;
    bool is_cancelled_ = false;
    progress_observer observer_;
    clock::time_point start_;
    progress state_;
    std::mutex mutex_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
