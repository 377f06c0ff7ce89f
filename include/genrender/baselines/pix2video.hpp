// SPDX-License-Identifier: MIT
// [GR sec. 4: Pix2Video*] The baseline in which every frame attends to an anchor and to the previous frame.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/baselines/previous_frame_attention.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// The pre-attention feature propagation of Pix2Video (Ceylan et al., ICCV 2023) as the paper adapts it, a model of
/// sequence_method: no inversion, no latent guidance, no correspondences. "Each frame attends to an anchor and previous
/// frame" is read as: keys and values of frame 0 and frame i - 1 replace those of frame i.
///
/// Frames are denoised in their order, one call of the denoiser after the other, so the run's loop has nothing to
/// share; a larger `settings.frames_per_call` gives the engine more at once. It needs an engine that calls back: what a
/// static graph is given (feature_io) always includes a frame's own keys. Of the settings it leaves unread: keyframes,
/// correspondence, alpha, pre_attention, post_attention, keeps_own_copy, counts_points, variance, first_fill_share. Logits are scaled by
/// `settings.injection.length_correction` where a frame attends to two others.
struct pix2video {
    /// None.
    template <class Real>
    std::vector<frame_index> keyframes(render_settings<Real> const&, std::size_t, std::size_t) const {
        return {};
    }

    /// Never.
    template <class Real>
    bool uses_correspondence(render_settings<Real> const&) const {
        return false;
    }

    /// Lists of sources in the steps of the window, with the stacks of features that earlier_frames keeps besides that of
    /// the call. The last call of a pass is not filled there.
    template <class Real>
    void shape(render_settings<Real> const& settings, run_shapes& shapes) const {
        std::size_t in_window = 0;
        for (std::size_t step = 0; step < settings.steps; ++step) {
            in_window += is_in_window(step, settings.steps, settings.window_begin, settings.window_end) ? 1U : 0U;
        }
        shapes.attends_to_stack = shapes.joins_keyframes = shapes.leaves_out = shapes.mixes_rows = false;
        shapes.row_width = 0;
        shapes.lists_sources = in_window > 0;
        shapes.scales_logits = in_window > 0 && settings.injection.length_correction > 0;
        shapes.counts_keys = shapes.keeps_variance = false;
        shapes.has_plain_steps = in_window < settings.steps;
        shapes.banks = in_window > 0 ? 2 : 0;
        shapes.storage = feature_storage::same;
        if (in_window > 0 && shapes.frames % shapes.frames_per_call > 0) {
            shapes.last_call = shapes.frames % shapes.frames_per_call;
        }
    }

    /// Estimates all frames; outside the window every frame by itself.
    template <class Passes>
    void operator()(Passes const& passes) const {
        using features_type = typename Passes::features_type;
        auto const& settings = passes.settings();
        if (!is_in_window(passes.step(), settings.steps, settings.window_begin, settings.window_end)) {
            passes.denoise_frames_alone();
            return;
        }
        earlier_frames<features_type> earlier;
        auto latest = passes.new_bank();
        std::size_t latest_count = 0;
        passes.denoise_frames_in_order([&](std::span<frame_index const> frames) {
            if (latest_count > 0) {
                earlier.add(std::exchange(latest, passes.new_bank()), latest_count);
            }
            latest_count = frames.size();
            return previous_frame_attention<features_type>(
                earlier, latest, [&passes](attention_place place) { return passes.takes_part(place); },
                passes.logit_scale());
        });
        passes.require_recorded(latest, "frames");
    }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
