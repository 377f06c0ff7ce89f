// SPDX-License-Identifier: MIT
// [GR alg. 1: the body of the loop] One evaluation D(z, sigma) of a whole animation under way: the passes that a
// sequence_method is made of.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/plain_attention.hpp>
#include <genrender/blending/blend_plans.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/plan_key.hpp>
#include <genrender/correspondence/correspondence_set.hpp>
#include <genrender/keyframes/recorder.hpp>
#include <genrender/keyframes/stoppable_denoiser.hpp>
#include <genrender/pipeline/pass_latents.hpp>
#include <genrender/pipeline/progress.hpp>
#include <genrender/pipeline/render_report.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <ranges>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender {

/// What all evaluations of a run share. All but the loop is referred to.
template <denoiser Phi, correspondence_map Map>
struct sequence_run {
    Phi const* phi;                      ///< the network
    correspondence_set<Map> const* maps; ///< correspondence at each feature resolution that takes part
    render_settings<typename Phi::real_type> const* settings; ///< of the run
    any_loop loop;                                            ///< over frames and what else is independent
    progress_meter* meter;                                    ///< tells the observer
    report_writer* report;                                    ///< notes what happens
};

/// The passes over an animation at one noise level. A pass gives the denoiser stacks of frames with a processor, counts
/// them for the observer and its seconds for the report; the method decides on passes and processors.
template <denoiser Phi, correspondence_map Map>
class sequence_passes {
public:
    using real_type = typename Phi::real_type;         ///< scalar of the latents
    using features_type = typename Phi::features_type; ///< the engine's handle of features
    using latents_type = run_latents<Phi>;             ///< z and x0, in host memory or lent
    /// Reads z and writes the clean estimates x0, both [frames, channels, height, width]. Everything is referred to and
    /// must outlive the evaluation.
    sequence_passes(sequence_run<Phi, Map> const& run, latents_type& x0, latents_type const& z, real_type sigma,
                    std::size_t step)
        : run_(&run), latents_(*run.phi, x0, z), sigma_(sigma), step_(step) {}

    /// Settings of the run.
    render_settings<real_type> const& settings() const { return *run_->settings; }
    /// Diffusion step, from 0.
    std::size_t step() const { return step_; }
    /// Number of frames of the animation.
    std::size_t frame_count() const { return latents_.frame_count(); }

    /// Whether the settings let a place take part.
    bool takes_part(attention_place place) const {
        return settings().layers(run_->phi->sites()[place.site.value], place.branch);
    }

    /// alpha of eq. 6 at a site in this step.
    real_type alpha(site_index site) const {
        return alpha_at(settings(), step_, run_->phi->sites()[site.value], grid_extents(run_->phi->latent_grid()));
    }
    /// What logits are multiplied by where frames are joined.
    auto logit_scale() const { return length_scale(run_->phi->sites(), settings().injection.length_correction); }
    /// An empty bank for features of all places.
    feature_bank<features_type> new_bank() const {
        return {static_cast<std::size_t>(std::ranges::size(run_->phi->sites())), run_->phi->branches()};
    }

    /// f_KF, F_KF <- Phi(z_KF, D_KF, c): denoises the frames KF as one stack, as far as the denoiser must run, and
    /// keeps their features at the places that take part; with `extended` they attend to each other (eq. 3). Throws
    /// value_error if the denoiser did not run the processor at one of these places, or cannot store features as the
    /// settings say.
    feature_bank<features_type> record_keyframes(std::vector<frame_index> const& KF, bool extended,
                                                 key_count_function counts = {}) const {
        run_->meter->begin(step_, render_pass::keyframes, KF.size());
        auto const start = clock::now();
        auto bank = new_bank();
        auto const of = [this](attention_place place) { return takes_part(place); };
        recorder<features_type> const record(bank, of, extended, settings().keyframe_storage, logit_scale(),
                                             std::move(counts));
        auto const denoiser = run_keyframes(KF, record);
        run_->report->add_seconds(denoiser, seconds_since(start) - denoiser);
        require_recorded(bank, "keyframes");
        run_->meter->add(KF.size());
        return bank;
    }

    /// Throws value_error unless the bank holds features of `whose` at every place that takes part: a denoiser may not
    /// have run the processor, or not have handed over what it asked for.
    void require_recorded(feature_bank<features_type> const& bank, char const* whose) const {
        auto const& sites = run_->phi->sites();
        for (std::uint32_t site = 0; site < std::ranges::size(sites); ++site) {
            for (std::uint32_t branch = 0; branch < run_->phi->branches(); ++branch) {
                if (takes_part({{site}, branch}) && bank.find({{site}, branch}) == nullptr) {
                    throw value_error(std::string("sequence_denoiser: features of ") + whose + " at site " +
                                      sites[site].name + " of branch " + std::to_string(branch) +
                                      " are missing, expected the denoiser to " +
                                      (bank.was_asked({{site}, branch})
                                           ? "call record_features(processor, place, f, F) after its graph has run, "
                                             "since inputs_at said is_recorded there"
                                           : "run its processor there"));
                }
            }
        }
    }

    /// One plan per feature resolution and frame, each a blend_plan made by `make_plan(map, frame)`, several at the same
    /// time if the loop has threads for them. A frame that comes twice has one plan. Rows carry keys of this pass.
    template <class MakePlan>
    blend_plans<real_type> make_plans(std::span<frame_index const> frames, MakePlan const& make_plan) const {
        std::vector<grid_extents> grid_of_site;
        for (auto const& site : run_->phi->sites()) {
            grid_of_site.push_back(site.grid);
        }
        blend_plans<real_type> plans(std::move(grid_of_site), evaluation_);
        std::set<frame_index> const different(frames.begin(), frames.end());
        struct wanted_plan {
            grid_extents grid;
            Map const* map;
            frame_index frame;
            blend_plan<real_type> plan;
        };
        std::vector<wanted_plan> wanted;
        for (auto const& [grid, map] : *run_->maps) {
            for (auto const frame : different) {
                wanted.push_back({grid, &map, frame, {}});
            }
        }
        run_->loop(wanted.size(), [&](std::size_t n) { wanted[n].plan = make_plan(*wanted[n].map, wanted[n].frame); });
        for (auto& [grid, map, frame, plan] : wanted) {
            plans.add(grid, frame, std::move(plan));
        }
        return plans;
    }

    /// Tells the report that a plan covers `covered` of the tokens of a frame at a grid that show an object.
    void report_coverage(grid_extents grid, frame_index frame, std::size_t covered) const {
        run_->report->add_coverage(grid, run_->maps->tokens_on_objects(grid, frame), covered);
    }

    /// z^i <- Phi(z^i, D^i, c) for every frame, `settings().frames_per_call` at once, with the processor that
    /// `make_processor(frames)` gives. Calls may run at the same time, `settings().calls_at_once` of them. If
    /// `settings().fills_last_call`, the frames of the last call may end with several times the last frame.
    template <class MakeProcessor>
    void denoise_frames(MakeProcessor const& make_processor) const {
        denoise_frames(run_->loop, true, make_processor);
    }

    /// The same one call after the other, from the first frame on, for methods in which a frame needs the one before.
    template <class MakeProcessor>
    void denoise_frames_in_order(MakeProcessor const& make_processor) const {
        denoise_frames(sequential_loop{}, false, make_processor);
    }

    /// Every frame by itself, as the network has it.
    void denoise_frames_alone() const {
        plain_attention const plain;
        denoise_frames([&](auto) -> plain_attention const& { return plain; });
    }

private:
    using clock = std::chrono::steady_clock;
    using seconds = std::chrono::duration<double>;
    static double seconds_since(clock::time_point start) { return seconds(clock::now() - start).count(); }

    /// The keyframe pass of a denoiser that can end it early, or of one that estimates frames that nobody asked for. Gives
    /// the seconds of the denoiser.
    double run_keyframes(std::vector<frame_index> const& KF, recorder<features_type> const& record) const {
        double taken = 0;
        auto const timed = [&](auto const& run) {
            auto const begin = clock::now();
            run();
            taken = seconds_since(begin);
        };
        if constexpr (stoppable_denoiser<Phi>) {
            auto const last = last_sites(*run_->phi, [this](attention_place place) { return takes_part(place); });
            latents_.read(KF, [&](auto const& z) {
                timed([&] {
                    if constexpr (residual_lender<Phi>) {
                        run_->phi->run_until(z, sigma_, KF, record, last,
                                             settings().reuses_keyframes ? &lent_ : nullptr);
                    } else {
                        run_->phi->run_until(z, sigma_, KF, record, last);
                    }
                });
            });
        } else {
            latents_.read_and_drop(
                KF, [&](auto const&... x0_and_z) { timed([&] { (*run_->phi)(x0_and_z..., sigma_, KF, record); }); });
        }
        return taken;
    }

    /// One call of the denoiser for the frames from `first` on, repeated up to `count` where the animation ends before.
    /// It may know something of its frames from the keyframe pass. Gives the seconds of the denoiser.
    template <class MakeProcessor>
    double run_call(std::size_t call, std::size_t first, std::size_t count, MakeProcessor const& make_processor) const {
        auto const own = std::min(count, frame_count() - first);
        std::vector<frame_index> frames;
        for (std::size_t i = 0; i < count; ++i) {
            frames.push_back({static_cast<std::uint32_t>(first + std::min(i, own - 1))});
        }
        auto const& processor = make_processor(std::span<frame_index const>(frames));
        return latents_.write(call, frames, own, [&](auto const&... x0_and_z) {
            std::span<frame_index const> const of_call(frames);
            if constexpr (residual_lender<Phi>) {
                return (*run_->phi)(x0_and_z..., sigma_, of_call, processor, lent_);
            } else {
                return (*run_->phi)(x0_and_z..., sigma_, of_call, processor);
            }
        });
    }

    /// Runs `body` for each call, as many at once as the settings let.
    template <class Body>
    void run_calls(any_loop const& loop, std::size_t calls, Body const& body) const {
        auto const lanes = settings().calls_at_once;
        if (lanes == 0 || lanes >= calls) {
            loop(calls, body);
            return;
        }
        // As many bodies of the loop as calls may run, so that no thread ever waits for another's call to end.
        std::atomic<std::size_t> next{0};
        loop(lanes, [&](std::size_t) {
            try {
                for (auto call = next++; call < calls; call = next++) {
                    body(call);
                }
            } catch (...) {
                next = calls;
                throw;
            }
        });
    }

    /// The pass over all frames; `fills` says whether the last call may be given a frame several times.
    template <class MakeProcessor>
    void denoise_frames(any_loop const& loop, bool fills, MakeProcessor const& make_processor) const {
        auto const count = frame_count();
        auto const stride = fills ? stack_size(settings(), count) : std::min(settings().frames_per_call, count);
        evaluation_ = next_evaluation();
        run_->meter->begin(step_, render_pass::frames, count);
        auto const pass_start = clock::now();
        std::mutex mutex;
        double in_denoiser = 0; // Seconds of threads, which share the pass's seconds by the clock on the wall.
        double outside = 0;
        auto const calls = (count + stride - 1) / stride;
        latents_.begin(calls);
        run_calls(loop, calls, [&](std::size_t call) {
            auto const start = clock::now();
            auto const first = call * stride;
            auto const own = std::min(stride, count - first);
            auto const denoiser =
                run_call(call, first, fills && settings().fills_last_call ? stride : own, make_processor);
            {
                std::lock_guard const lock(mutex);
                in_denoiser += denoiser;
                outside += seconds_since(start) - denoiser;
            }
            run_->meter->add(own);
        });
        latents_.end();
        auto const share = in_denoiser / std::max(in_denoiser + outside, 1e-12);
        auto const taken = seconds_since(pass_start);
        run_->report->add_seconds(taken * share, taken * (1 - share));
    }

    sequence_run<Phi, Map> const* run_;
    mutable pass_latents<Phi> latents_; // z; x0, written by the pass over all frames
    real_type sigma_;
    std::size_t step_;
    mutable std::uint64_t evaluation_ = 0; // of the pass under way; written before its calls
    mutable residuals_of<Phi> lent_{};     // written by the keyframe pass, before frames are denoised
};

} // namespace genrender

#include <genrender/core/end_header.inl>
