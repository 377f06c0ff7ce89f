// SPDX-License-Identifier: MIT
// [EDM alg. 1] What samplers and guidance do to the latents in a step, beside a copy of the same bytes.
#include <genrender/sampling/sampler.hpp>

#include <genrender/core/tensor.hpp>
#include <genrender/sampling/classifier_free_guidance.hpp>
#include <genrender/sampling/preconditioning.hpp>

#include <benchmark/benchmark.h>

#include <benchmarks/support/paired_timing.hpp>

#include <array>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

using namespace genrender;
using namespace genrender::benchmarks;

namespace {

/// `update(tensors)` reads and writes `passes` tensors of the latents in all.
template <class Update>
void updates(benchmark::State& state, std::size_t passes, Update const& update) {
    std::array<std::size_t, 4> const shape{static_cast<std::size_t>(state.range(0)), 4, 64, 64};
    std::array<latents<float>, 4> z;
    for (auto& each : z) {
        each = latents<float>::from_shape(shape);
        each.fill(0.25f);
    }
    auto const bytes = passes * z[0].size() * sizeof(float);
    std::vector<char> from(bytes / 2, 1);
    std::vector<char> to(bytes / 2, 2);
    time_against(
        state, {"copy of the same bytes"}, [&] { update(z); },
        [&] { std::memcpy(to.data(), from.data(), from.size()); });
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

void shapes(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"frames"})->Arg(24)->Arg(1000)->UseManualTime()->Unit(benchmark::kMicrosecond);
}

void euler_update(benchmark::State& state) {
    updates(state, 3, [](auto& z) { detail::write_euler_step(z[0], z[0], z[1], 2.0f, 1.9f); });
}
BENCHMARK(euler_update)->Apply(shapes);

void dpmpp_2m_update(benchmark::State& state) {
    updates(state, 4, [](auto& z) { detail::take_extrapolated_step(z[0], z[1], z[2], 0.5f, 2.0f, 1.9f); });
}
BENCHMARK(dpmpp_2m_update)->Apply(shapes);

/// Both halves of a step.
void heun_update(benchmark::State& state) {
    updates(state, 8, [](auto& z) {
        detail::write_euler_step(z[2], z[0], z[1], 2.0f, 1.9f);
        detail::take_mean_step(z[0], z[1], z[2], z[3], 2.0f, 1.9f);
    });
}
BENCHMARK(heun_update)->Apply(shapes);

void guidance(benchmark::State& state) {
    updates(state, 3, [](auto& z) { guide(to_view(z[0]), to_view(z[1]), to_view(z[2]), 7.5f); });
}
BENCHMARK(guidance)->Apply(shapes);

void preconditioning(benchmark::State& state) {
    updates(state, 3,
            [](auto& z) { to_clean(to_view(z[0]), prediction::epsilon, to_view(z[1]), to_view(z[2]), 2.0f); });
}
BENCHMARK(preconditioning)->Apply(shapes);

} // namespace
