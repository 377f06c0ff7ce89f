// SPDX-License-Identifier: MIT
// [GR sec. 3, 4] The laws of sequence_method, as a check of a model by whole runs.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/parallel.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/pipeline/progress.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/pipeline/render_report.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/sampling/sampler.hpp>
#include <genrender/testing/law_report.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <utility>

namespace genrender::testing {

/// The laws that a method breaks, and the latents of its run.
template <class Real>
struct sequence_method_report : law_report {
    latents<Real> z; ///< of the run
};

/// Checks the laws of sequence_method by five whole runs over `maps`, with a denoiser whose estimates do not depend on
/// how frames are stacked, to the bit: analytic_denoiser is one. Throws what render throws.
template <class Method, denoiser Phi, canonical_maps Maps>
sequence_method_report<typename Phi::real_type>
check_sequence_method_laws(Method const& method, Phi const& phi, Maps const& maps,
                           render_settings<typename Phi::real_type> settings) {
    using Real = typename Phi::real_type;
    sequence_method_report<Real> report;
    std::size_t const N = maps.frame_count();
    // Every evaluation runs the keyframes it announced and every frame once.
    std::map<std::size_t, std::size_t> keyframes;
    std::map<std::size_t, std::size_t> frames;
    std::size_t before = 0;
    progress last;
    auto const observe = [&](progress const& now) {
        auto const is_same_pass = last.step == now.step && last.pass == now.pass && now.frames_done > before;
        auto& count = now.pass == render_pass::keyframes ? keyframes[now.step] : frames[now.step];
        count += now.frames_done - (is_same_pass ? before : 0);
        before = now.frames_done;
        last = now;
        return true;
    };
    auto run = render<Method>(phi, maps, {.settings = settings, .method = method, .observer = observe});
    report.z = std::move(run.z);
    for (std::size_t step = 0; step < settings.steps; ++step) {
        auto const evaluations = evaluations_at(settings.sampler, step);
        auto const in_step = " in step " + std::to_string(step);
        report.require(frames[step] == evaluations * N, "sequence_method: every evaluation denoises every frame once",
                       std::to_string(frames[step]) + " frames" + in_step, std::to_string(evaluations * N));
        auto const announced = evaluations * method.keyframes(settings, N, step).size();
        report.require(keyframes[step] == announced,
                       "sequence_method: every evaluation runs the keyframes that it announced",
                       std::to_string(keyframes[step]) + " keyframes" + in_step, std::to_string(announced));
    }
    report.require(last.remaining_seconds == 0, "sequence_method: progress ends when all frames are done",
                   detail::number_text(last.remaining_seconds) + " seconds left at the end", "0");

    // Estimates depend neither on the loop nor on how many frames are denoised at once, nor on the runs before.
    for (auto const frames_per_call : {std::size_t{1}, std::size_t{2}, N, std::numeric_limits<std::size_t>::max()}) {
        settings.frames_per_call = frames_per_call;
        auto const again =
            render<Method>(phi, maps, {.settings = settings, .method = method, .loop = threaded_loop(2)});
        auto const with = "with " + std::to_string(frames_per_call) + " frames a call on two threads";
        report.require(std::equal(report.z.begin(), report.z.end(), again.z.begin(), again.z.end()),
                       "sequence_method: estimates depend neither on the loop nor on frames_per_call",
                       "other latents " + with, "the same");
        auto is_same_coverage = again.report.coverage.size() == run.report.coverage.size();
        for (auto const& [grid, count] : run.report.coverage) {
            auto const found = again.report.coverage.find(grid);
            is_same_coverage =
                is_same_coverage && found != again.report.coverage.end() && found->second.covered == count.covered;
        }
        report.require(is_same_coverage, "sequence_method: coverage depends neither on the loop nor on frames_per_call",
                       "another coverage " + with, "the same");
    }
    return report;
}

} // namespace genrender::testing

#include <genrender/core/end_header.inl>
