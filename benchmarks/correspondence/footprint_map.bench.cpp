// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Reading a frame's maps, making it ready to be searched, and matching all its tokens in another.
#include <genrender/correspondence/footprint_map.hpp>

#include <benchmark/benchmark.h>

#include <benchmarks/support/turning_world.hpp>

#include <cstddef>
#include <cstdint>

using namespace genrender;
using genrender::benchmarks::turning_world;

namespace {

constexpr std::uint32_t frames = 8;

turning_world const& world() {
    static turning_world const known(frames);
    return known;
}

/// Which pixel stands for each token.
void read_maps(benchmark::State& state) {
    auto const side = static_cast<std::size_t>(state.range(0));
    for (auto _ : state) {
        footprint_map const map(world().uv(), {side, side});
        benchmark::DoNotOptimize(map.frame_count());
    }
    state.SetItemsProcessed(state.iterations() * std::int64_t{frames});
}
BENCHMARK(read_maps)->ArgNames({"side"})->Arg(64)->Arg(16)->Unit(benchmark::kMillisecond);

/// What a frame needs to be a keyframe.
void sample_frame(benchmark::State& state) {
    auto const side = static_cast<std::size_t>(state.range(0));
    auto const maps = world().uv();
    std::uint32_t turn = 0;
    for (auto _ : state) {
        frame_index const i{turn++ % frames};
        frame_samples<2> const samples(maps, i, {side, side}, 1, [&](token_index token) {
            return representative_pixel(maps, i, {side, side}, token);
        });
        benchmark::DoNotOptimize(samples.samples_of({0}));
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(sample_frame)->ArgNames({"side"})->Arg(64)->Arg(16)->Unit(benchmark::kMillisecond);

/// Items are tokens that show an object.
template <class Map>
void match(benchmark::State& state, Map const& map) {
    std::size_t on_objects = 0;
    std::uint32_t turn = 0;
    for (auto _ : state) {
        frame_index const from{turn % frames};
        frame_index const to{(turn / frames + turn) % frames};
        ++turn;
        auto const matches = map.matches(from, {&to, 1});
        benchmark::DoNotOptimize(matches[0]->tokens.data());
    }
    for (std::uint32_t t = 0; t < map.grid().size(); ++t) {
        on_objects += map.point_at({0}, {t}) ? 1U : 0U;
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(on_objects));
}

void match_by_uv(benchmark::State& state) {
    auto const side = static_cast<std::size_t>(state.range(0));
    match(state, footprint_map(world().uv(), {side, side}, {.match_cache_bytes = 0}));
}
BENCHMARK(match_by_uv)->ArgNames({"side"})->Arg(64)->Arg(32)->Arg(16)->Arg(8)->Unit(benchmark::kMicrosecond);

void match_by_position(benchmark::State& state) {
    auto const side = static_cast<std::size_t>(state.range(0));
    match(state, footprint_map(world().position(), {side, side}, {.match_cache_bytes = 0}));
}
BENCHMARK(match_by_position)->ArgNames({"side"})->Arg(64)->Arg(32)->Arg(16)->Arg(8)->Unit(benchmark::kMicrosecond);

} // namespace
