// SPDX-License-Identifier: MIT
// [GR alg. 1] What a whole run spends outside the network, and what it holds beside what was planned.
#include <genrender/pipeline/render.hpp>

#include <genrender/core/tensor.hpp>
#include <genrender/maps/depth_maps.hpp>
#include <genrender/scene/rasterizer.hpp>
#include <genrender/reference/pipeline_files.hpp>
#include <genrender/reference/reference_network.hpp>
#include <genrender/reference/stable_diffusion.hpp>

#include <benchmarks/support/costless_denoiser.hpp>
#include <benchmarks/support/median.hpp>
#include <benchmarks/support/native_floors.hpp>
#include <benchmarks/support/own_process.hpp>
#include <benchmarks/support/paired_timing.hpp>
#include <benchmarks/support/turning_world.hpp>
#include <benchmarks/support/unet_flops.hpp>

#include <examples/scenes/walking_figure.hpp>
#include <examples/support/plan_output.hpp>
#include <examples/support/resident_memory.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

using namespace genrender;

using namespace genrender::reference;
using namespace genrender::benchmarks;

namespace {

/// The walk of the demo with maps twice as large as its frames, and the miniature.
class walk {
public:
    walk(std::size_t frames, std::size_t size)
        : guidance_(rasterize(scenes::walking_figure(frames), {2 * size, 2 * size}, loop_)), phi_(network(size)) {}
    walk(walk const&) = delete;

    uv_maps_view maps() const { return to_uv_view(guidance_.uv); }
    auto const& phi() const { return phi_; }
    threaded_loop const& loop() const { return loop_; }

private:
    reference_network<float> network(std::size_t size) {
        auto const nearness = cell_means(sequence_inverse_depth(guidance_.depth), {size, size});
        return pipeline_.network(
            pipeline_.conditioning(to_view(nearness),
                                   {.text = "a red and white striped figure on green ground", .guidance_scale = 3},
                                   loop_),
            loop_);
    }

    threaded_loop loop_;
    rendered_guidance guidance_;
    reference::stable_diffusion<float> pipeline_{pipeline_files(GENRENDER_MINIATURE "/weights")};
    reference_network<float> phi_;
};

/// Balls on a floor seen from all around, maps eight times as large as the latents, and a denoiser of Stable
/// Diffusion's shape that costs nothing.
class device_run {
public:
    explicit device_run(std::size_t frames, std::size_t side = 64) : world_(frames, 8 * side), phi_(side) {}

    uv_maps_view maps() const { return world_.uv(); }
    costless_denoiser const& phi() const { return phi_; }
    threaded_loop const& loop() const { return loop_; }

private:
    threaded_loop loop_;
    turning_world world_;
    costless_denoiser phi_;
};

render_settings<float> settings_of(std::size_t steps, std::size_t keyframes) {
    render_settings<float> settings;
    settings.steps = steps;
    settings.keyframes.count = keyframes;
    return settings;
}

/// Seconds by the clock on the wall of a whole run, and those in the denoiser.
struct run_seconds {
    double total;
    double denoiser;
};

template <class Run>
run_seconds render_timed(Run const& run, render_settings<float> const& settings) {
    double denoiser = 0;
    auto const total = seconds_of([&] {
        auto const result = render(run.phi(), run.maps(), {.settings = settings, .loop = run.loop()});
        benchmark::DoNotOptimize(result.z.data());
        denoiser = result.report.denoiser_seconds;
    });
    return {total, denoiser};
}

/// The share of a run that is spent outside the denoiser's calls: noise, geometry, keyframes, plans, normalisation, the
/// sampler and whatever else there is. Mixing belongs to the calls.
void whole_run(benchmark::State& state) {
    walk const run(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
    auto const settings = settings_of(static_cast<std::size_t>(state.range(2)), 4);
    for (auto _ : state) {
        auto const [total, denoiser] = render_timed(run, settings);
        state.SetIterationTime(total);
        state.counters["library_share"] = 1 - denoiser / total;
    }
}
BENCHMARK(whole_run)
    ->ArgNames({"frames", "size", "steps"})
    ->Args({12, 128, 20})
    ->Iterations(1)
    ->Repetitions(1)
    ->UseManualTime()
    ->Unit(benchmark::kSecond);

/// FLOPs a second of Eigen's products of 1024^3, one on each thread of the loop.
double product_rate(threaded_loop const& loop) {
    constexpr std::size_t n = 1024;
    std::vector<float> const A(n * n, 0.5F);
    std::vector<float> const B(n * n, 0.25F);
    std::vector<std::vector<float>> C(loop.threads(), std::vector<float>(n * n));
    std::vector<double> seconds;
    for (std::size_t turn = 0; turn < 9; ++turn) {
        seconds.push_back(seconds_of(
            [&] { loop(C.size(), [&](std::size_t i) { native_product(C[i].data(), A.data(), B.data(), n, n, n); }); }));
    }
    return static_cast<double>(C.size()) * 2 * n * n * n / median(std::move(seconds));
}

/// What the library takes of a frame and step at Stable Diffusion's shapes, in a run whose network costs nothing,
/// beside the least that the network would take on this machine: its UNet alone, once a branch, without ControlNet,
/// keyframes and attention to them, every FLOP at the rate of Eigen's products on all threads. An engine may have a
/// faster device for its network: the target holds as long as a frame and step take it `two_percent_of_seconds`.
void library_at_stable_diffusion(benchmark::State& state) {
    auto const frames = static_cast<std::size_t>(state.range(0));
    auto const steps = static_cast<std::size_t>(state.range(1));
    device_run const run(frames);
    auto const flops = static_cast<double>(run.phi().branches()) * unet_flops({}, run.phi().latent_grid(), 77);
    for (auto _ : state) {
        auto const before = product_rate(run.loop());
        auto const library = render_timed(run, settings_of(steps, 5)).total / static_cast<double>(frames * steps);
        auto const network = flops / std::max(before, product_rate(run.loop()));
        state.SetIterationTime(library);
        state.counters["network_seconds"] = network;
        state.counters["share_of_network"] = library / network;
        state.counters["two_percent_of_seconds"] = library / 0.02;
    }
    state.SetLabel("network: 2 x 0.80 TFLOP at the rate of Eigen's products on all threads");
}
BENCHMARK(library_at_stable_diffusion)
    ->ArgNames({"frames", "steps"})
    ->Args({24, 50})
    ->Iterations(1)
    ->Repetitions(1)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);

/// What becomes of memory that a run frees.
enum class freed_memory { is_returned, may_stay };

/// What runs of so many frames held.
using bytes_by_frames = std::map<std::size_t, double>;

/// What a run took of the machine.
struct run_memory {
    double bytes;
    double seconds;
};

/// Of a run in a process of its own, whose memory no earlier run has left; none if it failed.
template <class MakeRun>
std::optional<run_memory> memory_taken(MakeRun const& make_run, render_settings<float> const& settings,
                                       std::size_t frames, freed_memory freed) {
    return in_own_process([&] {
        if (freed == freed_memory::is_returned) {
            examples::return_freed_memory();
        }
        // Code and threads are there before the measurement, which is of data.
        render_timed(*make_run(settings.keyframes.count), settings);
        auto const run = make_run(frames);
        double seconds = 0;
        auto const bytes = examples::resident_growth([&] { seconds = render_timed(*run, settings).total; });
        return run_memory{static_cast<double>(bytes.value()), seconds};
    });
}

/// Plans a run as the option --plan does, and runs it twice: with an allocator that returns what is freed to the
/// system, so that what is resident is what the run holds, and with the system's, which keeps some of it at its own
/// discretion (`resident`). The error is the plan's for what is held; growth is what each frame adds beyond those of
/// the case with fewer, and `beyond_latents` what in it is no latents, over the latents that live at once.
template <class MakeRun>
void measure_memory(benchmark::State& state, MakeRun const& make_run, render_settings<float> const& settings,
                    bytes_by_frames& by_frames) {
    auto const frames = static_cast<std::size_t>(state.range(0));
    for (auto _ : state) {
        auto const planned = in_own_process([&] {
            auto const run = make_run(frames);
            return examples::plan_run(run->phi(), run->maps(), settings, run->loop().threads()).plan.bytes;
        });
        auto const held = memory_taken(make_run, settings, frames, freed_memory::is_returned);
        auto const resident = memory_taken(make_run, settings, frames, freed_memory::may_stay);
        if (!planned || !held || !resident) {
            state.SkipWithError("the run, its plan or the system's account of its memory failed");
            return;
        }
        auto const plan = static_cast<double>(planned->peak);
        auto const latents = static_cast<double>(planned->latents) / static_cast<double>(frames);
        state.SetIterationTime(resident->seconds);
        state.counters["planned_bytes"] = plan;
        state.counters["held_bytes"] = held->bytes;
        state.counters["resident_bytes"] = resident->bytes;
        state.counters["plan_error"] = std::abs(plan / held->bytes - 1);
        if (auto const fewer = by_frames.lower_bound(frames); fewer != by_frames.begin()) {
            auto const& [count, bytes] = *std::prev(fewer);
            auto const growth = (held->bytes - bytes) / static_cast<double>(frames - count);
            state.counters["growth_a_frame_bytes"] = growth;
            state.counters["beyond_latents"] = growth / latents - 1;
        }
        by_frames[frames] = held->bytes;
    }
}

/// Of all that a run holds, features of the miniature included, in few steps.
void memory_of_run(benchmark::State& state) {
    auto const size = static_cast<std::size_t>(state.range(1));
    auto const steps = static_cast<std::size_t>(state.range(2));
    static std::map<std::pair<std::size_t, std::size_t>, bytes_by_frames> known;
    auto const make_run = [&](std::size_t frames) { return std::make_unique<walk>(frames, size); };
    measure_memory(state, make_run, settings_of(steps, 4), known[{size, steps}]);
}
BENCHMARK(memory_of_run)
    ->ArgNames({"frames", "size", "steps"})
    ->Args({24, 32, 2})
    ->Args({240, 32, 2})
    ->Args({1000, 32, 2})
    ->Args({24, 128, 2})
    ->Iterations(1)
    ->Repetitions(1)
    ->UseManualTime()
    ->Unit(benchmark::kSecond);

/// Of the library alone, by the latents of a network of Stable Diffusion's shape whose features lie elsewhere.
void memory_of_library(benchmark::State& state) {
    auto const side = static_cast<std::size_t>(state.range(1));
    auto const steps = static_cast<std::size_t>(state.range(2));
    static std::map<std::pair<std::size_t, std::size_t>, bytes_by_frames> known;
    auto const make_run = [&](std::size_t frames) { return std::make_unique<device_run>(frames, side); };
    measure_memory(state, make_run, settings_of(steps, 5), known[{side, steps}]);
}
BENCHMARK(memory_of_library)
    ->ArgNames({"frames", "latents", "steps"})
    ->Args({24, 16, 20})
    ->Args({240, 16, 20})
    ->Args({1000, 16, 20})
    ->Args({24, 64, 50})
    ->Iterations(1)
    ->Repetitions(1)
    ->UseManualTime()
    ->Unit(benchmark::kSecond);

} // namespace
