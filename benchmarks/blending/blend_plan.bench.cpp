// SPDX-License-Identifier: MIT
// [GR alg. 1] The plans of a step beside applying them at all sites of Stable Diffusion's decoder.
#include <genrender/blending/blend_plan.hpp>

#include <genrender/blending/mix_rows.hpp>
#include <genrender/correspondence/footprint_map.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>

#include <benchmark/benchmark.h>

#include <benchmarks/support/median.hpp>
#include <benchmarks/support/paired_timing.hpp>
#include <benchmarks/support/turning_world.hpp>

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::benchmarks;

namespace {

/// Three sites of two guidance branches at each feature resolution.
struct resolution {
    std::size_t side;
    std::size_t channels;
};
constexpr std::array<resolution, 3> resolutions{{{64, 320}, {32, 640}, {16, 1280}}};
constexpr std::size_t sites = 6;
constexpr std::size_t keyframes = 5;

/// The maps of an animation, and features to apply plans to.
struct decoder_world {
    turning_world world;
    std::vector<footprint_map<2>> maps;
    std::vector<stack<float, 2>> F;
    std::vector<stack<float, 3>> F_KF;

    decoder_world(std::size_t frames, footprint_map_settings const& settings) : world(frames) {
        for (auto const& [side, channels] : resolutions) {
            maps.emplace_back(world.uv(), grid_extents{side, side}, settings);
            F.emplace_back(std::array{side * side, channels});
            F_KF.emplace_back(std::array{keyframes, side * side, channels});
            std::fill_n(F.back().data(), F.back().size(), 1.0f);
            std::fill_n(F_KF.back().data(), F_KF.back().size(), 1.0f);
        }
    }

    std::vector<blend_plan<float>> plans(std::vector<frame_index> const& KF, frame_index i) const {
        std::vector<blend_plan<float>> result;
        for (auto const& map : maps) {
            result.push_back(make_blend_plan<float>(map, KF, i, 0.5f, texel_average::by_quality));
        }
        return result;
    }

    void apply(std::vector<blend_plan<float>> const& plans) {
        for (std::size_t r = 0; r < plans.size(); ++r) {
            for (std::size_t site = 0; site < sites; ++site) {
                mix_rows(F[r].view(), F_KF[r], plans[r].rows(), 0.7f);
            }
        }
        benchmark::DoNotOptimize(F.data());
    }
};

/// The plans of one frame, of all resolutions: matched anew, or from the matches that an earlier step left.
void make_blend_plan(benchmark::State& state) {
    constexpr std::uint32_t frames = 12;
    static std::map<bool, std::unique_ptr<decoder_world>> worlds;
    auto const is_kept = state.range(0) != 0;
    if (!worlds[is_kept]) {
        footprint_map_settings settings;
        settings.match_cache_bytes = is_kept ? settings.match_cache_bytes : 0;
        worlds[is_kept] = std::make_unique<decoder_world>(frames, settings);
    }
    auto& world = *worlds[is_kept];
    std::vector<frame_index> const KF{{9}, {1}, {11}, {5}, {7}};
    for (std::uint32_t i = 0; i < frames; ++i) {
        world.plans(KF, {i});
    }
    std::vector<double> shares;
    std::uint32_t turn = 0;
    for (auto _ : state) {
        frame_index const i{turn++ % frames};
        std::vector<blend_plan<float>> plans;
        auto const seconds = seconds_of([&] { plans = world.plans(KF, i); });
        state.SetIterationTime(seconds);
        shares.push_back(seconds / seconds_of([&] { world.apply(plans); }));
    }
    state.counters["share_of_applying"] = median(std::move(shares));
}
BENCHMARK(make_blend_plan)->ArgNames({"kept"})->Arg(1)->Arg(0)->UseManualTime()->Unit(benchmark::kMicrosecond);

/// All plans of a run that draws keyframes anew in each step, per frame and step.
void plans_of_a_run(benchmark::State& state) {
    auto const frames = static_cast<std::size_t>(state.range(0));
    auto const steps = static_cast<std::size_t>(state.range(1));
    for (auto _ : state) {
        decoder_world world(frames, {});
        double seconds = 0;
        std::vector<double> applying;
        for (std::size_t step = 0; step < steps; ++step) {
            keyframe_settings settings;
            settings.count = keyframes;
            auto const KF = draw_keyframes(settings, frames, step);
            for (std::uint32_t i = 0; i < frames; ++i) {
                std::vector<blend_plan<float>> plans;
                seconds += seconds_of([&] { plans = world.plans(KF, {i}); });
                if (i % 8 == 0) {
                    applying.push_back(seconds_of([&] { world.apply(plans); }));
                }
            }
        }
        auto const a_frame = seconds / static_cast<double>(frames * steps);
        state.SetIterationTime(a_frame);
        state.counters["share_of_applying"] = a_frame / median(std::move(applying));
    }
}
BENCHMARK(plans_of_a_run)
    ->ArgNames({"frames", "steps"})
    ->Args({24, 50})
    ->Iterations(1)
    ->Repetitions(2)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

} // namespace
