// SPDX-License-Identifier: MIT
// [GR eq. 6] The kernel of blending at the shapes of Stable Diffusion's decoder, beside a copy of the same bytes; on more
// and more threads beside one; and the same by way of a texture in memory.
#include <genrender/blending/mix_rows.hpp>

#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/mix_rows_keeping_variance.hpp>
#include <genrender/core/linalg.hpp>
#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/correspondence/footprint_map.hpp>

#include <benchmark/benchmark.h>

#include <benchmarks/support/on_threads.hpp>
#include <benchmarks/support/paired_timing.hpp>
#include <benchmarks/support/turning_world.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

using namespace genrender;
using namespace genrender::benchmarks;

namespace {

constexpr std::size_t frames = 16;
std::vector<frame_index> const KF{{9}, {1}, {14}, {5}, {12}};

/// The plans of all frames of the turning world at tokens of a square grid.
std::vector<blend_plan<float>> const& plans_of(std::size_t tokens) {
    static turning_world const world(frames);
    static std::map<std::size_t, std::vector<blend_plan<float>>> known;
    auto& plans = known[tokens];
    if (plans.empty()) {
        auto const side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(tokens))));
        footprint_map const map(world.uv(), {side, side});
        for (std::uint32_t i = 0; i < frames; ++i) {
            plans.push_back(make_blend_plan<float>(map, KF, {i}));
        }
    }
    return plans;
}

/// Every token mixes a random token of each keyframe.
blend_plan<float> const& worst_plan(std::size_t tokens) {
    static std::map<std::size_t, blend_plan<float>> known;
    auto& plan = known[tokens];
    if (plan.sources.empty()) {
        for (std::uint32_t t = 0; t < tokens; ++t) {
            for (std::uint32_t k = 0; k < KF.size(); ++k) {
                auto const bound = static_cast<std::uint32_t>(tokens);
                plan.sources.push_back(k * bound + uniform_below(bound, 1, random_stream::test, {t, k, 0}));
                plan.weights.push_back(0.2f);
            }
            plan.offsets.push_back(static_cast<std::uint32_t>(plan.sources.size()));
        }
    }
    return plan;
}

template <class T>
stack<T, 3> filled(std::array<std::size_t, 3> const& extents) {
    stack<T, 3> values(extents);
    std::fill_n(values.data(), values.size(), static_cast<T>(0.25f));
    return values;
}

/// Numbers of variance 1, so that there is something to keep.
stack<float, 3> random_values(std::array<std::size_t, 3> const& extents) {
    stack<float, 3> values(extents);
    for (std::uint32_t e = 0; e < values.size(); ++e) {
        values.data()[e] = static_cast<float>(normal_value(1, random_stream::test, {e, 0, 0}));
    }
    return values;
}

/// Bytes of applying a plan: every source is read, every covered row read and written.
template <class Stored>
std::size_t bytes_of(blend_plan<float> const& plan, std::size_t channels) {
    return channels * (plan.sources.size() * sizeof(Stored) + 2 * plan.covered_count() * sizeof(float));
}

/// Applies plans to frames one after the other, each time beside a copy of as many bytes. `Fs` [frames, tokens,
/// channels] is what the frames are.
template <class Stored>
void mix_frames(benchmark::State& state, std::vector<blend_plan<float> const*> const& plans, std::size_t count) {
    auto const tokens = static_cast<std::size_t>(state.range(0));
    auto const channels = static_cast<std::size_t>(state.range(1));
    auto F = filled<float>({count, tokens, channels});
    auto const F_KF = filled<Stored>({KF.size(), tokens, channels});
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < count; ++i) {
        bytes += bytes_of<Stored>(*plans[i % plans.size()], channels);
    }
    std::vector<char> from(bytes / 2, 1);
    std::vector<char> to(bytes / 2, 2);
    time_against(
        state, {"copy of the same bytes"},
        [&] {
            for (std::size_t i = 0; i < count; ++i) {
                mix_rows(F.view()[i], in_view<Stored, 3>(F_KF.view()), plans[i % plans.size()]->rows(), 0.7f);
            }
        },
        [&] { std::memcpy(to.data(), from.data(), from.size()); });
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count * tokens));
    state.counters["sources_a_row"] = static_cast<double>(plans[0]->sources.size()) /
                                      static_cast<double>(std::max<std::size_t>(1, plans[0]->covered_count()));
}

std::vector<blend_plan<float> const*> pointers_to(std::vector<blend_plan<float>> const& plans) {
    std::vector<blend_plan<float> const*> pointers;
    for (auto const& plan : plans) {
        pointers.push_back(&plan);
    }
    return pointers;
}

void shapes(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"tokens", "channels"})
        ->Args({4096, 320})
        ->Args({1024, 640})
        ->Args({256, 1280})
        ->Args({64, 1280})
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
}

template <class Stored>
void mix(benchmark::State& state) {
    mix_frames<Stored>(state, {&plans_of(static_cast<std::size_t>(state.range(0)))[7]}, 1);
}
BENCHMARK(mix<float>)->Apply(shapes);
BENCHMARK(mix<float16>)->Apply(shapes);
BENCHMARK(mix<bfloat16>)->Apply(shapes);

void mix_five_random_sources(benchmark::State& state) {
    mix_frames<float>(state, {&worst_plan(static_cast<std::size_t>(state.range(0)))}, 1);
}
BENCHMARK(mix_five_random_sources)->Apply(shapes);

/// Eq. 6 that keeps variance, beside eq. 6 that does not: moments beside the sums, and one more sweep over F.
void keeping_variance(benchmark::State& state) {
    auto const tokens = static_cast<std::size_t>(state.range(0));
    auto const channels = static_cast<std::size_t>(state.range(1));
    auto const F_KF = random_values({KF.size(), tokens, channels});
    auto kept = random_values({1, tokens, channels});
    auto mixed = kept;
    auto const rows = plans_of(tokens)[7].rows();
    time_against(
        state, {"mix rows"},
        [&] { mix_rows_keeping_variance(kept.view()[0], F_KF, rows, 0.7f, {variance_target::total}); },
        [&] { mix_rows(mixed.view()[0], F_KF, rows, 0.7f); });
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(tokens));
}
BENCHMARK(keeping_variance)->Apply(shapes);

/// More than the caches hold.
void mix_many_frames(benchmark::State& state) {
    mix_frames<float>(state, pointers_to(plans_of(static_cast<std::size_t>(state.range(0)))),
                      static_cast<std::size_t>(state.range(2)));
}
BENCHMARK(mix_many_frames)
    ->ArgNames({"tokens", "channels", "frames"})
    ->Args({4096, 320, 64})
    ->Args({1024, 640, 128})
    ->Args({256, 1280, 256})
    ->Repetitions(3) // each has to fill a third of a gigabyte
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

/// The tokens of a frame, shared out over threads.
void mix_on_threads(benchmark::State& state) {
    constexpr std::size_t tokens = 4096;
    constexpr std::size_t channels = 320;
    auto F = filled<float>({1, tokens, channels});
    auto const F_KF = filled<float>({KF.size(), tokens, channels});
    auto const rows = plans_of(tokens)[7].rows();
    time_on_threads(state, [&](threaded_loop const& loop) { mix_rows(F.view()[0], F_KF, rows, 0.7f, loop); });
}
BENCHMARK(mix_on_threads)->Apply(on_thread_counts);

/// The same by way of a texture in memory, once for one frame: each keyframe is written to the texels of its tokens'
/// squares, their mean and first fill are taken, and the frame reads the texel of each of its tokens.
void dense_texture(benchmark::State& state) {
    auto const tokens = static_cast<std::size_t>(state.range(0));
    auto const channels = static_cast<std::size_t>(state.range(1));
    auto const T = static_cast<std::size_t>(state.range(2));
    auto const side = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(tokens))));
    auto const F_KF = filled<float>({KF.size(), tokens, channels});
    auto F = filled<float>({1, tokens, channels});
    std::vector<float> sum(T * T * channels);
    std::vector<float> first(T * T * channels);
    std::vector<std::uint8_t> seen(T * T);
    for (auto _ : state) {
        std::fill(sum.begin(), sum.end(), 0.0f);
        std::fill(seen.begin(), seen.end(), std::uint8_t{0});
        for (std::size_t k = 0; k < KF.size(); ++k) {
            for (std::size_t texel = 0; texel < T * T; ++texel) {
                auto const token = texel / T * side / T * side + texel % T * side / T;
                auto const* const in = F_KF.data() + (k * tokens + token) * channels;
                for (std::size_t c = 0; c < channels; ++c) {
                    sum[texel * channels + c] += in[c];
                }
                if (seen[texel]++ == 0) {
                    std::copy_n(in, channels, &first[texel * channels]);
                }
            }
        }
        for (std::size_t texel = 0; texel < T * T; ++texel) {
            for (std::size_t c = 0; c < channels; ++c) {
                auto& value = sum[texel * channels + c];
                value = 0.5f * (first[texel * channels + c] + value / static_cast<float>(seen[texel]));
            }
        }
        for (std::size_t t = 0; t < tokens; ++t) {
            auto const texel = (t / side * T + T / 2) / side * T + (t % side * T + T / 2) / side;
            for (std::size_t c = 0; c < channels; ++c) {
                auto& value = F.data()[t * channels + c];
                value = 0.3f * value + 0.7f * sum[texel * channels + c];
            }
        }
        benchmark::DoNotOptimize(F.data());
    }
}
BENCHMARK(dense_texture)
    ->ArgNames({"tokens", "channels", "texels"})
    ->Args({4096, 320, 1024})
    ->Args({1024, 640, 1024})
    ->Args({4096, 320, 256}) // beside a peer, which takes half a minute for the first
    ->Iterations(1)
    ->Repetitions(2)
    ->Unit(benchmark::kMillisecond);

} // namespace
