// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Latent normalisation beside a copy of the bytes that it goes through.
#include <genrender/normalization/adain.hpp>

#include <genrender/core/random.hpp>
#include <genrender/core/stack.hpp>

#include <benchmark/benchmark.h>

#include <benchmarks/support/paired_timing.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::benchmarks;

namespace {

constexpr std::size_t channels = 4;

struct latents_and_masks {
    stack<float, 4> z;
    stack<std::uint8_t, 3> background;

    latents_and_masks(std::size_t frames, std::size_t side)
        : z({frames, channels, side, side}), background({frames, side, side}) {
        for (std::uint32_t e = 0; e < z.size(); ++e) {
            z.data()[e] = static_cast<float>(uniform_value(1, random_stream::test, {e, 0, 0}));
        }
        for (std::size_t e = 0; e < background.size(); ++e) {
            background.data()[e] = e % side < side / 3 ? 1 : 0;
        }
    }
};

void shapes(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"frames", "latents"})
        ->Args({24, 64})
        ->Args({1000, 64})
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
}

void statistics(benchmark::State& state) {
    latents_and_masks const given(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
    auto const bytes = given.z.size() * sizeof(float) + given.background.size();
    std::vector<char> from(bytes / 2, 1);
    std::vector<char> to(bytes / 2, 2);
    time_against(
        state, {"copy of the same bytes"},
        [&] {
            for (std::size_t i = 0; i < given.z.extent(0); ++i) {
                auto const known = masked_statistics(given.z.view()[i], given.background.view()[i]);
                benchmark::DoNotOptimize(known.mean.data());
            }
        },
        [&] { std::memcpy(to.data(), from.data(), from.size()); });
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}
BENCHMARK(statistics)->Apply(shapes);

/// Statistics, which read the latents, and the normalisation, which reads and writes them.
void normalize(benchmark::State& state) {
    latents_and_masks given(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)));
    auto const bytes = 3 * given.z.size() * sizeof(float) + given.background.size();
    std::vector<char> from(bytes / 2, 1);
    std::vector<char> to(bytes / 2, 2);
    time_against(
        state, {"copy of the same bytes"},
        [&] { normalize_latents(given.z.view(), std::as_const(given.background).view()); },
        [&] { std::memcpy(to.data(), from.data(), from.size()); });
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}
BENCHMARK(normalize)->Apply(shapes);

} // namespace
