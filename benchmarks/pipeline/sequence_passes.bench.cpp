// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi(z^i, D^i, c, f_KF, F_bar^i)] The injected pass on several threads beside one, and a keyframe pass
// that ends early and lends beside one that does neither.
#include <genrender/pipeline/sequence_passes.hpp>

#include <genrender/maps/uv_maps.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/reference/reference_network.hpp>

#include "benchmarks/support/miniature_config.hpp"
#include "benchmarks/support/on_threads.hpp"
#include "benchmarks/support/paired_timing.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using benchmarks::floor_of;
using benchmarks::time_against;

namespace {

constexpr std::size_t frame_count = 12;
constexpr std::size_t size = 64; // pixels; latents have a quarter as many

/// A slope that a wave crosses, as large textures on it move to the side.
struct wave {
    stack<float, 3> inverse_depth{{frame_count, size, size}};
    uv_maps maps{frame_count, {size, size}};

    wave() {
        for (std::size_t i = 0; i < frame_count; ++i) {
            for (std::size_t row = 0; row < size; ++row) {
                for (std::size_t column = 0; column < size; ++column) {
                    auto const x = static_cast<float>(column + 2 * i) / 96;
                    auto const y = static_cast<float>(row) / 96;
                    inverse_depth(i, row, column) = 0.5F + 0.3F * std::sin(12 * x) * y;
                    maps.uv(i, row, column, 0) = x;
                    maps.uv(i, row, column, 1) = y;
                    maps.coverage(i, row, column) = row > 8 ? 1 : 0;
                }
            }
        }
    }
};

using network = reference_network<float>;

/// The miniature with random weights and a prompt of any numbers.
network seeded_miniature(in_view<float, 3> inverse_depth, any_loop const& loop) {
    auto const config = benchmarks::miniature_config();
    auto unet_weights = weights<float>::seeded(1, "unet");
    auto control_weights = weights<float>::seeded(1, "controlnet");
    stack<float, 2> prompt({benchmarks::miniature_prompt_tokens, config.cross_attention_dim});
    for (std::size_t e = 0; e < prompt.size(); ++e) {
        prompt.data()[e] = static_cast<float>(e * 7919 % 1009) / 504.0F - 1;
    }
    return {config,
            unet_weights,
            control_weights,
            {.hint = depth_hint<float>(inverse_depth, config.conditioning_channels),
             .prompt = prompt,
             .empty_prompt = stack<float, 2>(prompt.extents())},
            loop};
}

/// One evaluation on so many threads.
struct world {
    wave guidance;
    threaded_loop loop;
    network phi;
    render_settings<float> settings;
    correspondence_set<chosen_correspondence<2>> maps;
    progress_meter meter{1, 1, {}};
    render_report report;
    report_writer writer{report};
    latents<float> z = latents<float>::from_shape({frame_count, 8, size / 4, size / 4});
    latents<float> x0 = z;
    std::vector<frame_index> KF{{2}, {9}, {5}, {0}};

    explicit world(std::size_t threads) : loop(threads), phi(seeded_miniature(guidance.inverse_depth, loop)) {
        for (auto const& site : phi.sites()) {
            maps.add(site.grid, [&](grid_extents grid) {
                return chosen_correspondence<2>(to_uv_view(guidance.maps), grid, settings.correspondence, loop);
            });
        }
        for (std::size_t e = 0; e < z.size(); ++e) {
            z.data()[e] =
                static_cast<float>(normal_value(1, random_stream::user, {static_cast<std::uint32_t>(e), 0, 0}));
        }
    }
    world(world const&) = delete;

    using run_type = sequence_run<network, chosen_correspondence<2>>;
    using passes_type = sequence_passes<network, chosen_correspondence<2>>;
    run_type run() { return {&phi, &maps, &settings, loop, &meter, &writer}; }
};

/// Every frame with the features of four keyframes.
void inject(world::passes_type const& passes, feature_bank<network::features_type> const& bank,
            std::vector<frame_index> const& KF) {
    passes.denoise_frames([&](std::span<frame_index const> frames) {
        auto plans = passes.make_plans(
            frames, [&](auto const& map, frame_index i) { return make_blend_plan<float>(map, KF, i); });
        return injector<network::features_type, float>(bank, KF, std::move(plans), {},
                                                       [&](site_index site) { return passes.alpha(site); });
    });
}

/// The injected pass on `threads` threads; its share is how many times as fast it is as on one.
void injected_pass(benchmark::State& state) {
    world many(static_cast<std::size_t>(state.range(0)));
    world one(1);
    auto const run_many = many.run();
    auto const run_one = one.run();
    world::passes_type const on_many(run_many, many.x0, many.z, 1.0F, 0);
    world::passes_type const on_one(run_one, one.x0, one.z, 1.0F, 0);
    auto const bank_of_many = on_many.record_keyframes(many.KF, true);
    auto const bank_of_one = on_one.record_keyframes(one.KF, true);
    time_against(
        state, floor_of{"one thread"}, [&] { inject(on_many, bank_of_many, many.KF); },
        [&] { inject(on_one, bank_of_one, one.KF); });
    if (!std::equal(many.x0.begin(), many.x0.end(), one.x0.begin())) {
        state.SkipWithError("the frames depend on the number of threads");
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(frame_count));
}
BENCHMARK(injected_pass)->Apply(benchmarks::on_thread_counts);

/// One evaluation of the method, keyframes and frames; its share is what reuse of keyframes saves: 1 is nothing.
void evaluation_with_reuse(benchmark::State& state) {
    world with(static_cast<std::size_t>(state.range(0)));
    world without(static_cast<std::size_t>(state.range(0)));
    without.settings.reuses_keyframes = false;
    auto const evaluate = [](world& w) {
        auto const run = w.run();
        world::passes_type const passes(run, w.x0, w.z, 1.0F, 0);
        auto const bank = passes.record_keyframes(w.KF, true);
        inject(passes, bank, w.KF);
    };
    time_against(
        state, floor_of{"keyframes computed twice"}, [&] { evaluate(with); }, [&] { evaluate(without); });
    if (!std::equal(with.x0.begin(), with.x0.end(), without.x0.begin())) {
        state.SkipWithError("the frames depend on reuse");
    }
}
BENCHMARK(evaluation_with_reuse)->ArgName("threads")->Arg(1)->UseManualTime()->Unit(benchmark::kMillisecond);

} // namespace
