// SPDX-License-Identifier: MIT
// One self-attention module of an engine's static graphs beside the same module of the library's own call.
#pragma once

#include "../injection/dense_equations.hpp"
#include "../support/plans_of.hpp"

#include <genrender/injection/feature_io.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace genrender::testing {

/// What a comparison varies.
struct module_case {
    bool pre_attention = true;
    bool post_attention = true;
    bool keeps_own_copy = false;
    feature_storage storage = feature_storage::same;
};

/// The greatest differences of an engine's output and the library's.
struct module_differences {
    double plain = 0;
    double keyframe = 0;
    double injected = 0;
    double second_step = 0; ///< of the injected pass after a keyframe pass with other features
};

/// Runs all three passes of a module [frames, 12 tokens, 8 channels] at one of two branches. An engine is made of
/// (shapes, sites, module), and `engine(processor, place, frames, f)` gives F as a stack.
template <class Engine>
module_differences compare_module(module_case const& with) {
    constexpr std::size_t tokens = 12;
    constexpr std::size_t channels = 8;
    constexpr attention_place place{{1}, 1};
    std::vector<frame_index> const KF{{5}, {2}, {0}};
    std::vector<frame_index> const frames{{1}, {2}};
    attention_site const site{"attn1", network_kind::denoising, network_part::decoder, {3, 4}, channels};
    std::array const sites{site, site};
    matrix_module<float> const module(channels, 2, 1);

    run_shapes shapes;
    shapes.frames = 6;
    shapes.keyframes = KF.size();
    shapes.frames_per_call = shapes.last_call = frames.size();
    shapes.row_width = 3; // of random_plan
    shapes.places = {place};
    shapes.joins_keyframes = with.pre_attention;
    shapes.mixes_rows = with.post_attention;
    shapes.leaves_out = !with.keeps_own_copy;
    shapes.lists_sources = false;
    shapes.storage = with.storage;
    Engine engine(shapes, sites, module);

    std::vector<random_plan<float>> const plans{{tokens, KF.size(), 4}, {tokens, KF.size(), 5}, {tokens, KF.size(), 6}};
    auto const by_frame =
        plans_of<float>(2, frames, [&](site_index, frame_index frame) { return plans[frame.value].rows(); });
    injection_settings settings;
    settings.pre_attention = with.pre_attention;
    settings.post_attention = with.post_attention;
    settings.keeps_own_copy = with.keeps_own_copy;
    auto const alpha = [](site_index) { return 0.6f; };
    auto const always = [](attention_place) { return true; };

    auto const difference = [&](auto const& engines, auto const& library, std::span<frame_index const> stack,
                                std::uint64_t seed) {
        auto const f = random_stack<float, 3>({stack.size(), tokens, channels}, seed);
        auto copy_of_f = f;
        host_attention_call<float, matrix_module<float>> call(place, stack, host_features<float>(copy_of_f.view()),
                                                              module);
        auto const expected = library(call);
        auto const F = engine(engines, place, stack, f);
        double greatest = 0;
        for (std::size_t e = 0; e < F.size(); ++e) {
            greatest = std::max<double>(greatest, std::abs(F.data()[e] - expected.view().data()[e]));
        }
        return greatest;
    };

    module_differences result;
    result.plain = difference(plain_attention{}, plain_attention{}, frames, 10);
    for (auto const step : {0u, 1u}) {
        feature_bank<typename Engine::features_type> engine_bank(2, 2);
        feature_bank<host_features<float>> library_bank(2, 2);
        recorder<typename Engine::features_type> const records(engine_bank, always, true, with.storage);
        recorder<host_features<float>> const recorded(library_bank, always, true, with.storage);
        auto const keyframe = difference(records, recorded, KF, 20 + step);
        result.keyframe = std::max(result.keyframe, keyframe);
        injector<typename Engine::features_type, float> const injects(engine_bank, KF, by_frame, settings, alpha);
        injector<host_features<float>, float> const injected(library_bank, KF, by_frame, settings, alpha);
        (step == 0 ? result.injected : result.second_step) = difference(injects, injected, frames, 30 + step);
    }
    return result;
}

} // namespace genrender::testing
