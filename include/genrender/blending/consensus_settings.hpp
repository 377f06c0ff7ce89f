// SPDX-License-Identifier: MIT
// How the clean estimates of frames agree along the surfaces: from which frames, in which steps and how much.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/quality_weights.hpp>
#include <genrender/core/error.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>

#include <cstddef>
#include <functional>

namespace genrender {

/// The consensus of clean estimates, which any method and any denoiser can have: a mean along the surfaces with the
/// deviation of what it is the mean of (consensus.hpp), between the method and latent normalisation.
template <class Real>
struct consensus_settings {
    bool enabled = true; ///< whether there is one at all
    /// Steps that have it: those whose share step / steps lies in [window_begin, window_end). Late steps draw detail finer
    /// than a latent cell can agree on.
    Real window_begin = 0;
    Real window_end = Real(0.7); ///< see window_begin
    /// How far estimates move towards it, in [0, 1], by step of the window.
    std::function<Real(std::size_t step)> strength = [](std::size_t) { return Real(1); };
    /// Frames that it is the mean of, the same for all frames of a step, drawn anew each step from numbers of their own;
    /// all where `count` is more than there are. Cost grows with frames times these, memory with these alone.
    keyframe_settings sources{.count = 16, .drawing = keyframe_drawing::stratified, .frames = {}, .seed = 0};
    Real first_fill_share = 0; ///< of the first source that sees a point; the rest is the average of all that do
    texel_average average = texel_average::by_quality; ///< how the average weighs the sources
    quality_settings quality{};                        ///< what qualities do besides, over the steps of the run
    /// The most that a channel's deviation is multiplied by to give back what averaging took; 1 gives nothing back.
    Real most_gain = 2;
    /// Whether a cell that shows its object partly moves by that share alone; else every covered cell moves alike.
    bool fades_at_silhouettes = true;
    /// Whether cells without any object agree too, in every step and each at its place on the screen, where nothing is
    /// resampled: all sources that show background there alike. Of no effect unless their noise stands still
    /// (background_noise::fixed): another sky turns with the camera.
    bool agrees_on_background = true;
    /// Cells around an object, in each direction, that do not agree on the background: a decoder mixes what is that near.
    std::size_t background_distance = 2;
};

/// Throws value_error for settings that no run of `steps` steps could honour, in the name of `function`.
template <class Real>
void require_consensus_settings(char const* function, consensus_settings<Real> const& settings, std::size_t steps) {
    auto const require = [&](bool holds, char const* argument, auto const& value, char const* expected) {
        require_value(holds, function, argument, value, expected);
    };
    require(settings.window_begin >= 0 && settings.window_begin <= settings.window_end && settings.window_end <= 1,
            "settings.consensus.window_end", settings.window_end, "0 <= window_begin <= window_end <= 1");
    require(settings.strength != nullptr, "settings.consensus.strength", "empty", "a function");
    for (std::size_t step = 0; settings.enabled && step < steps; ++step) {
        auto const strength = settings.strength(step);
        require(strength >= 0 && strength <= 1, "settings.consensus.strength", strength, "shares in [0, 1]");
    }
    require(settings.first_fill_share >= 0 && settings.first_fill_share <= 1, "settings.consensus.first_fill_share",
            settings.first_fill_share, "a share in [0, 1]");
    require(settings.most_gain >= 1, "settings.consensus.most_gain", settings.most_gain, "a factor of at least 1");
    require(settings.sources.count >= 1, "settings.consensus.sources.count", settings.sources.count,
            "at least one frame");
    require_quality_settings(function, settings.quality, "settings.consensus.");
}

} // namespace genrender

#include <genrender/core/end_header.inl>
