// SPDX-License-Identifier: MIT
// What every sequence_method owes beyond its concept, as checks for the library's models and for users' own.
#pragma once

#include <genrender/maps/uv_maps.hpp>
#include <genrender/pipeline/render.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>

namespace genrender::testing {

/// Checks the laws of sequence_method by whole runs over `maps` with a denoiser whose results do not depend on how
/// frames are stacked, to the bit. Returns the latents.
template <class Method, denoiser Phi>
latents<typename Phi::real_type> check_sequence_method_laws(Method const& method, Phi const& phi, uv_maps const& maps,
                                                            render_settings<typename Phi::real_type> settings) {
    auto const N = maps.frame_count();
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
    auto const [z, report, is_cancelled] =
        render<Method>(phi, to_uv_view(maps), {.settings = settings, .method = method, .observer = observe});
    for (std::size_t step = 0; step < settings.steps; ++step) {
        auto const evaluations = evaluations_at(settings.sampler, step);
        REQUIRE(frames[step] == evaluations * N);
        REQUIRE(keyframes[step] == evaluations * method.keyframes(settings, N, step).size());
    }
    REQUIRE(last.remaining_seconds == 0);

    // Estimates depend neither on the loop nor on how many frames are denoised at once.
    for (auto const frames_per_call : {std::size_t{1}, std::size_t{2}, N, std::numeric_limits<std::size_t>::max()}) {
        settings.frames_per_call = frames_per_call;
        auto const again =
            render<Method>(phi, to_uv_view(maps), {.settings = settings, .method = method, .loop = threaded_loop(2)});
        REQUIRE(std::equal(z.begin(), z.end(), again.z.begin()));
        REQUIRE(again.report.coverage.size() == report.coverage.size());
        for (auto const& [grid, count] : report.coverage) {
            REQUIRE(again.report.coverage.at(grid).covered == count.covered);
        }
    }
    return z;
}

} // namespace genrender::testing
