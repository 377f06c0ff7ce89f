// SPDX-License-Identifier: MIT
// [GR alg. 1: the body of the loop] A denoiser of single frames becomes a denoiser of the whole animation.
#pragma once

#include <genrender/attention/plain_attention.hpp>
#include <genrender/blending/blend_plan.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/correspondence/correspondence_set.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/keyframes/recorder.hpp>
#include <genrender/pipeline/progress.hpp>
#include <genrender/pipeline/render_report.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <ranges>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

/// The diffusion step at a noise level: the step i with sigmas[i] >= sigma > sigmas[i + 1]. A second evaluation within
/// a step, such as Heun's, thereby counts to the step that begins at its own level.
template <class Real>
std::size_t step_at(std::span<Real const> sigmas, std::type_identity_t<Real> sigma) {
    std::size_t step = 0;
    while (step + 2 < sigmas.size() && sigmas[step + 1] >= sigma) {
        ++step;
    }
    return step;
}

/// Whether a step lies in the window [begin, end) of shares of all steps.
template <class Real>
bool is_in_window(std::size_t step, std::size_t steps, Real begin, std::type_identity_t<Real> end) {
    auto const share = static_cast<Real>(step) / static_cast<Real>(steps);
    return share >= begin && share < end;
}

/// Whether a step draws keyframes: it lies in the window, and something is injected.
template <class Real>
bool has_keyframes(render_settings<Real> const& settings, std::size_t step) {
    return (settings.pre_attention || settings.post_attention) &&
           is_in_window(step, settings.steps, settings.window_begin, settings.window_end);
}

/// D(z, sigma) of a whole animation: draws keyframes, records their features, blends them along the correspondences,
/// denoises every frame with them and normalises the clean estimates. Any sampler drives it; it keeps nothing from one
/// evaluation to the next, and what it draws depends on the seed and the noise level alone.
template <denoiser Phi, correspondence_map Map, parallel_loop Loop>
class sequence_denoiser {
public:
    using real_type = typename Phi::real_type;
    using features_type = typename Phi::features_type;

    /// `sigmas` are the run's noise levels; `background` [frames, height, width] of the latents. Everything is referred
    /// to and must outlive the sequence denoiser.
    sequence_denoiser(Phi const& phi, correspondence_set<Map> const& maps,
                      strided_view<std::uint8_t const, 3> background, std::span<real_type const> sigmas,
                      render_settings<real_type> const& settings, Loop const& loop, progress_meter& meter,
                      render_report& report)
        : phi_(&phi), maps_(&maps), background_(background), sigmas_(sigmas), settings_(&settings), loop_(&loop),
          meter_(&meter), report_(&report) {}

    /// The clean estimates of all frames of z [frames, channels, height, width]. Throws value_error if an estimate is
    /// not finite, cancelled if the observer says so, and what the denoiser throws.
    latents<real_type> operator()(latents<real_type> const& z, real_type sigma) const {
        auto const step = step_at(sigmas_, sigma);
        auto x0 = latents<real_type>::from_shape(z.shape());
        if (has_keyframes(*settings_, step)) {
            auto const KF = draw_keyframes(settings_->keyframes, z.shape()[0], step);
            auto const bank = record_keyframes(z, sigma, step, KF);
            inject_frames(x0, z, sigma, step, KF, bank);
        } else {
            plain_attention const plain;
            denoise_frames(x0, z, sigma, step, [&](auto) -> plain_attention const& { return plain; });
        }
        require_finite(x0, step);
        auto const& normalization = settings_->normalization;
        if (normalization.enabled && !normalization.on_noisy_latents) {
            normalize(x0, step);
        }
        return x0;
    }

    /// Normalises latents of the whole sequence in place where the settings' window holds `step` [GR sec. 3.4].
    void normalize(latents<real_type>& z, std::size_t step) const {
        auto const& normalization = settings_->normalization;
        if (is_in_window(step, settings_->steps, normalization.window_begin, normalization.window_end)) {
            auto const start = clock::now();
            report_->add_skipped(normalize_latents(to_view(z), background_, normalization));
            report_->add_seconds(0, seconds_since(start));
        }
    }

private:
    using clock = std::chrono::steady_clock;
    using plans_type = std::map<std::pair<grid_extents, frame_index>, blend_plan<real_type>>;

    static double seconds_since(clock::time_point start) {
        return std::chrono::duration<double>(clock::now() - start).count();
    }

    bool takes_part(attention_place place) const {
        return settings_->layers(phi_->sites()[place.site.value], place.branch);
    }

    /// f_KF, F_KF <- Phi(z_KF, D_KF, c)
    feature_bank<features_type> record_keyframes(latents<real_type> const& z, real_type sigma, std::size_t step,
                                                 std::vector<frame_index> const& KF) const {
        meter_->begin(step, render_pass::keyframes, KF.size());
        auto const start = clock::now();
        auto const& shape = z.shape();
        auto z_KF = latents<real_type>::from_shape({KF.size(), shape[1], shape[2], shape[3]});
        auto x0_KF = z_KF; // Not read: keyframes are denoised again with all the others.
        for (std::size_t k = 0; k < KF.size(); ++k) {
            copy(to_view(z_KF)[k], to_view(z)[KF[k].value]);
        }
        feature_bank<features_type> bank(std::ranges::size(phi_->sites()), phi_->branches());
        recorder<features_type> const record(
            bank, [this](attention_place place) { return takes_part(place); }, settings_->pre_attention);
        auto const begin = clock::now();
        (*phi_)(to_view(x0_KF), to_view(std::as_const(z_KF)), sigma, KF, record);
        auto const denoiser = seconds_since(begin);
        report_->add_seconds(denoiser, seconds_since(start) - denoiser);
        require_recorded(bank);
        meter_->add(KF.size());
        return bank;
    }

    /// Refuses a denoiser that did not run the processor, or did not hand over what it asked for.
    void require_recorded(feature_bank<features_type> const& bank) const {
        for (std::uint32_t site = 0; site < std::ranges::size(phi_->sites()); ++site) {
            for (std::uint32_t branch = 0; branch < phi_->branches(); ++branch) {
                if (takes_part({{site}, branch}) && bank.find({{site}, branch}) == nullptr) {
                    throw value_error("sequence_denoiser: features of keyframes at site " + phi_->sites()[site].name +
                                      " of branch " + std::to_string(branch) +
                                      " are missing, expected the denoiser to run its processor there");
                }
            }
        }
    }

    /// z^i <- Phi(z^i, D^i, c, f_KF, F_bar^i) for every frame
    void inject_frames(latents<real_type>& x0, latents<real_type> const& z, real_type sigma, std::size_t step,
                       std::vector<frame_index> const& KF, feature_bank<features_type> const& bank) const {
        injection_settings<real_type> injection;
        injection.pre_attention = settings_->pre_attention;
        injection.post_attention = settings_->post_attention;
        injection.keeps_own_copy = settings_->keeps_own_copy;
        injection.alpha = [this, step](site_index site) { return settings_->alpha(step, phi_->sites()[site.value]); };

        denoise_frames(x0, z, sigma, step, [&](std::span<frame_index const> frames) {
            auto plans = std::make_shared<plans_type const>(plans_of(frames, KF));
            return injector<features_type, real_type>(
                bank, KF,
                [this, plans](site_index site, frame_index frame) {
                    return plans->at({phi_->sites()[site.value].grid, frame}).rows();
                },
                injection);
        });
    }

    /// F_bar^i = pi_i(T_bar_KF) as one plan per feature resolution and frame.
    plans_type plans_of(std::span<frame_index const> frames, std::vector<frame_index> const& KF) const {
        plans_type plans;
        if (!settings_->post_attention) {
            return plans;
        }
        for (auto const& [grid, map] : *maps_) {
            for (auto const frame : frames) {
                auto plan = make_blend_plan<real_type>(map, KF, frame, settings_->first_fill_share);
                std::size_t on_objects = 0;
                for (std::uint32_t t = 0; t < grid.size(); ++t) {
                    on_objects += map.point_at(frame, {t}).has_value() ? 1U : 0U;
                }
                report_->add_coverage(grid, on_objects, plan.covered_count());
                plans.emplace(std::pair(grid, frame), std::move(plan));
            }
        }
        return plans;
    }

    /// Runs the denoiser over all frames, a few at a time, with the processor that `make_processor(frames)` gives.
    template <class MakeProcessor>
    void denoise_frames(latents<real_type>& x0, latents<real_type> const& z, real_type sigma, std::size_t step,
                        MakeProcessor const& make_processor) const {
        auto const count = z.shape()[0];
        auto const stride = std::min(settings_->frames_per_call, count);
        meter_->begin(step, render_pass::frames, count);
        auto const pass_start = clock::now();
        std::mutex mutex;
        double in_denoiser = 0; // Seconds of threads, which share the pass's seconds by the clock on the wall.
        double outside = 0;
        (*loop_)((count + stride - 1) / stride, [&](std::size_t call) {
            auto const start = clock::now();
            auto const first = call * stride;
            std::vector<frame_index> frames;
            for (auto i = first; i < std::min(first + stride, count); ++i) {
                frames.push_back({static_cast<std::uint32_t>(i)});
            }
            auto const& processor = make_processor(std::span<frame_index const>(frames));
            auto const begin = clock::now();
            (*phi_)(to_view(x0).slice(first, frames.size()), to_view(z).slice(first, frames.size()), sigma, frames,
                    processor);
            auto const denoiser = seconds_since(begin);
            {
                std::lock_guard const lock(mutex);
                in_denoiser += denoiser;
                outside += seconds_since(start) - denoiser;
            }
            meter_->add(frames.size());
        });
        auto const share = in_denoiser / std::max(in_denoiser + outside, 1e-12);
        auto const seconds = seconds_since(pass_start);
        report_->add_seconds(seconds * share, seconds * (1 - share));
    }

    /// Refuses estimates that would poison every later step.
    static void require_finite(latents<real_type> const& x0, std::size_t step) {
        auto const values = x0.size() / x0.shape()[0];
        for (std::size_t i = 0; i < x0.size(); ++i) {
            if (!std::isfinite(x0.data()[i])) {
                throw value_error("sequence_denoiser: the denoiser's estimate of frame " + std::to_string(i / values) +
                                  " in step " + std::to_string(step) + " is " + std::to_string(x0.data()[i]) +
                                  ", expected finite latents");
            }
        }
    }

    Phi const* phi_;
    correspondence_set<Map> const* maps_;
    strided_view<std::uint8_t const, 3> background_;
    std::span<real_type const> sigmas_;
    render_settings<real_type> const* settings_;
    Loop const* loop_;
    progress_meter* meter_;
    render_report* report_;
};

} // namespace genrender
