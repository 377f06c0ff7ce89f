// SPDX-License-Identifier: MIT
// [GR alg. 1: the body of the loop] The paper's method: keyframes, blending along the correspondences, injection.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/blend_plans.hpp>
#include <genrender/blending/point_counts.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// Whether plans are made in steps with keyframes: for eq. 6, or to count the keys of a surface point.
inline bool makes_plans(injection_settings const& injection) {
    return injection.post_attention || (injection.pre_attention && injection.counts_points);
}

/// Whether a step draws keyframes: it lies in the window, and something is injected.
template <class Real>
bool has_keyframes(render_settings<Real> const& settings, std::size_t step) {
    return (settings.injection.pre_attention || settings.injection.post_attention) &&
           is_in_window(step, settings.steps, settings.window_begin, settings.window_end);
}

/// The model of sequence_method that `render` runs by default: draws keyframes, records their features in extended
/// attention, blends them into the unified texture, and denoises every frame with pre- and post-attention injection. A
/// step without keyframes leaves every frame to itself.
struct generative_rendering {
    /// KF of a step; none where nothing is injected. Throws as draw_keyframes does.
    template <class Real>
    std::vector<frame_index> keyframes(render_settings<Real> const& settings, std::size_t frames,
                                       std::size_t step) const {
        return has_keyframes(settings, step) ? draw_keyframes(settings.keyframes, frames, step)
                                             : std::vector<frame_index>{};
    }

    /// Needs them if it makes plans, in any step that has keyframes.
    template <class Real>
    bool uses_correspondence(render_settings<Real> const& settings) const {
        for (std::size_t step = 0; makes_plans(settings.injection) && step < settings.steps; ++step) {
            if (has_keyframes(settings, step)) {
                return true;
            }
        }
        return false;
    }

    /// Eqs. 3, 5 and 6 as the settings switch them on.
    template <class Real>
    void shape(render_settings<Real> const& settings, run_shapes& shapes) const {
        auto const has_keyframes = shapes.keyframes > 0;
        shapes.attends_to_stack = has_keyframes && settings.injection.pre_attention;
        shapes.joins_keyframes = shapes.attends_to_stack;
        shapes.leaves_out = shapes.joins_keyframes && !settings.injection.keeps_own_copy;
        shapes.mixes_rows = has_keyframes && settings.injection.post_attention;
        shapes.row_width = shapes.mixes_rows ? shapes.row_width : 0;
        shapes.lists_sources = false;
        shapes.scales_logits = shapes.attends_to_stack && settings.injection.length_correction > 0;
        shapes.counts_keys = shapes.attends_to_stack && settings.injection.counts_points;
        shapes.keeps_variance = shapes.mixes_rows && settings.injection.variance.target != variance_target::none;
        shapes.banks = has_keyframes ? 1 : 0;
        shapes.storage = has_keyframes ? shapes.storage : feature_storage::same;
    }

    /// The body of Alg. 1's loop.
    template <class Passes>
    void operator()(Passes const& passes) const {
        using real_type = typename Passes::real_type;
        using injector_type = injector<typename Passes::features_type, real_type>;
        auto const& settings = passes.settings();
        auto const KF = keyframes(settings, passes.frame_count(), passes.step());
        if (KF.empty()) {
            passes.denoise_frames_alone();
            return;
        }
        auto const weights = settings.quality.at(passes.step(), settings.steps);
        auto const make_plan = [&](auto const& map, frame_index i) {
            return make_blend_plan<real_type>(map, KF, i, settings.first_fill_share, settings.average, weights);
        };
        blend_plans<real_type> of_keyframes;
        key_count_function counts;
        if (settings.injection.pre_attention && settings.injection.counts_points) {
            of_keyframes = passes.make_plans(KF, make_plan);
            counts = [&](site_index site, frame_index frame) {
                return point_counts_of_stack(of_keyframes.rows(site, frame), KF.size());
            };
        }
        // f_KF, F_KF <- Phi(z_KF, D_KF, c)
        auto const bank = passes.record_keyframes(KF, settings.injection.pre_attention, counts);

        // z^i <- Phi(z^i, D^i, c, f_KF, F_bar^i), F_bar^i = pi_i(T_bar_KF)
        passes.denoise_frames([&](std::span<frame_index const> frames) {
            blend_plans<real_type> plans;
            if (makes_plans(settings.injection)) {
                plans = passes.make_plans(frames, [&](auto const& map, frame_index i) {
                    auto plan = make_plan(map, i);
                    passes.report_coverage(map.grid(), i, plan.covered_count());
                    return plan;
                });
            }
            return injector_type(
                bank, KF, std::move(plans), settings.injection,
                [&passes](site_index site) { return passes.alpha(site); }, passes.logit_scale());
        });
    }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
