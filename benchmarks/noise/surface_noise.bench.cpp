// SPDX-License-Identifier: MIT
// [GR sec. 3.3] The surface noise of a frame beside the random numbers that it is made of.
#include <genrender/noise/surface_noise.hpp>

#include <genrender/core/stack.hpp>

#include <benchmark/benchmark.h>

#include <benchmarks/support/paired_timing.hpp>
#include <benchmarks/support/turning_world.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>

using namespace genrender;
using namespace genrender::benchmarks;

namespace {

constexpr std::size_t channels = 4;
constexpr std::size_t frames = 4;

turning_world const& world() {
    static turning_world const known(frames);
    return known;
}

/// Cells of noise that the frame divides: all that lie around the cells that it looks at, below the first that parts.
template <class Maps>
std::size_t divided_cells(Maps const& maps, frame_index i, std::size_t side) {
    std::size_t count = 0;
    auto const looks = look_at_noise(maps, i, {side, side}, background_noise::fixed, {});
    for (auto const& [object, requests] : looks.objects) {
        std::set<std::pair<std::uint32_t, std::array<std::uint64_t, Maps::dimensions>>> cells;
        for (auto const& request : requests) {
            for (auto level = request.level; level-- > 0;) {
                auto corner = request.place;
                for (auto& coordinate : corner) {
                    coordinate >>= noise_tree<Maps::dimensions>::deepest - level;
                }
                if (!cells.emplace(level, corner).second) {
                    break;
                }
            }
        }
        count += cells.size();
    }
    return count;
}

template <class Maps>
void noise_of(benchmark::State& state, Maps const& maps) {
    auto const side = static_cast<std::size_t>(state.range(0));
    stack<float, 3> z({channels, side, side});
    frame_index const i{1};
    auto const blocks = divided_cells(maps, i, side) * ((std::size_t{1} << Maps::dimensions) / 4);
    constexpr std::array<std::array<std::uint32_t, 4>, channels> counters{
        {{0, 0, 2, 0}, {0, 1, 2, 0}, {0, 2, 2, 0}, {0, 3, 2, 0}}};
    std::array<double, 4 * channels> values;
    time_against(
        state, {"the random numbers alone"}, [&] { surface_noise(z.view(), maps, i, 1); },
        [&] {
            for (std::uint32_t block = 0; block < blocks; ++block) {
                normals_of(counters, {block, 1}, values.data());
                benchmark::DoNotOptimize(values);
            }
        });
    state.counters["numbers"] = static_cast<double>(4 * channels * blocks);
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(z.size()));
}

void surface_noise_by_uv(benchmark::State& state) { noise_of(state, world().uv()); }
BENCHMARK(surface_noise_by_uv)->ArgNames({"latents"})->Arg(64)->Arg(32)->UseManualTime()->Unit(benchmark::kMillisecond);

void surface_noise_by_position(benchmark::State& state) { noise_of(state, world().position()); }
BENCHMARK(surface_noise_by_position)->ArgNames({"latents"})->Arg(64)->UseManualTime()->Unit(benchmark::kMillisecond);

} // namespace
