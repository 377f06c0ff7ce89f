// SPDX-License-Identifier: MIT
// [GR sec. 4: TokenFlow*] The baseline that skips self-attention between keyframes and interpolates their outputs.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/baselines/propagation_plan.hpp>
#include <genrender/baselines/token_propagation.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// The extended attention and token propagation of TokenFlow (Geyer et al., ICLR 2024) as the paper adapts it, a model
/// of sequence_method: keyframes attend to each other, every other frame takes, token by token, the outputs of the
/// keyframes before and after it at the corresponding tokens, weighted by distance in time. Correspondences are the
/// scene's own instead of matched features; there is no inversion and no injection of features of a source video.
///
/// Keyframes are drawn as `settings.keyframes` says; TokenFlow's own draw is keyframe_drawing::stratified. The report's
/// coverage counts tokens on objects that a neighbouring keyframe shows. Of the settings it leaves unread: alpha,
/// pre_attention, post_attention, keeps_own_copy, counts_points, variance, first_fill_share, and texel_reading::average, of which it takes
/// the token of greatest weight. Keyframes attend to each other with logits scaled by `settings.injection.length_correction`.
struct tokenflow {
    /// KF of a step in the window. Throws as draw_keyframes does.
    template <class Real>
    std::vector<frame_index> keyframes(render_settings<Real> const& settings, std::size_t frames,
                                       std::size_t step) const {
        return is_in_window(step, settings.steps, settings.window_begin, settings.window_end)
                   ? draw_keyframes(settings.keyframes, frames, step)
                   : std::vector<frame_index>{};
    }

    /// Always.
    template <class Real>
    bool uses_correspondence(render_settings<Real> const&) const {
        return true;
    }

    /// Eq. 3 among keyframes, whose outputs are mixed in; a row takes from two keyframes at most, a token of each.
    template <class Real>
    void shape(render_settings<Real> const& settings, run_shapes& shapes) const {
        auto const has_keyframes = shapes.keyframes > 0;
        shapes.attends_to_stack = has_keyframes;
        shapes.joins_keyframes = shapes.leaves_out = shapes.lists_sources = false;
        shapes.mixes_rows = has_keyframes;
        shapes.scales_logits = has_keyframes && settings.injection.length_correction > 0;
        shapes.counts_keys = shapes.keeps_variance = false;
        shapes.row_width = std::min<std::size_t>(shapes.keyframes, 2);
        shapes.banks = has_keyframes ? 1 : 0;
        shapes.storage = has_keyframes ? shapes.storage : feature_storage::same;
    }

    /// Estimates all frames; outside the window every frame by itself. A keyframe runs again with the others and takes
    /// its own outputs, which gives the estimate of the keyframes' pass.
    template <class Passes>
    void operator()(Passes const& passes) const {
        using real_type = typename Passes::real_type;
        auto const KF = keyframes(passes.settings(), passes.frame_count(), passes.step());
        if (KF.empty()) {
            passes.denoise_frames_alone();
            return;
        }
        auto const bank = passes.record_keyframes(KF, true);
        passes.denoise_frames([&](std::span<frame_index const> frames) {
            auto plans = passes.make_plans(frames, [&](auto const& map, frame_index i) {
                auto propagation = make_propagation_plan<real_type>(map, KF, i);
                passes.report_coverage(map.grid(), i, propagation.matched);
                return std::move(propagation.plan);
            });
            return token_propagation<typename Passes::features_type, real_type>(bank, std::move(plans));
        });
    }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
