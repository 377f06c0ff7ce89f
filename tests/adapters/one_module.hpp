// SPDX-License-Identifier: MIT
// What every adapter of static graphs is tested by: one self-attention module beside the library's own call, and a denoiser
// whose estimate is known.
#pragma once

#include "../injection/dense_equations.hpp"
#include "../support/plans_of.hpp"

#include <genrender/adapters/graph_denoiser.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/injection/host_attention_call.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace genrender::testing {

/// What a comparison varies.
struct module_case {
    bool pre_attention = true;
    bool post_attention = true;
    bool keeps_own_copy = false;
    feature_storage storage = feature_storage::same;
    double length_correction = 0;
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
    shapes.scales_logits = with.length_correction > 0;
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
    auto const scale = length_scale(sites, with.length_correction);

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
        recorder<typename Engine::features_type> const records(engine_bank, always, true, with.storage, scale);
        recorder<host_features<float>> const recorded(library_bank, always, true, with.storage, scale);
        auto const keyframe = difference(records, recorded, KF, 20 + step);
        result.keyframe = std::max(result.keyframe, keyframe);
        injector<typename Engine::features_type, float> const injects(engine_bank, KF, by_frame, settings, alpha,
                                                                      scale);
        injector<host_features<float>, float> const injected(library_bank, KF, by_frame, settings, alpha, scale);
        (step == 0 ? result.injected : result.second_step) = difference(injects, injected, frames, 30 + step);
    }
    return result;
}

/// A module as an adapter's graphs, one for each pass and number of frames. `Module` is made of the matrices and has
/// `graph_type`, `device()` and `build(graph, f)`, which gives F [frames, tokens, channels] of site 1.
template <class Module>
struct graph_module {
    using graph_type = typename Module::graph_type;
    using features_type = typename graph_type::feature_io_type::features_type;

    graph_module(run_shapes const& shapes, std::span<attention_site const> sites, matrix_module<float> const& matrices)
        : module(matrices), io(graph_type::make_feature_io(module.device(), shapes, sites, true)) {}

    template <class Processor>
    stack<float, 3> operator()(Processor const& processor, attention_place place, std::span<frame_index const> frames,
                               stack<float, 3> const& f) {
        adapters::graph_key const key{io->pass_of(processor, frames), frames.size(), place.branch};
        auto& graph = graphs[key];
        if (graph == nullptr) {
            graph = std::make_unique<graph_type>(module.device(), *io, key);
            graph->finish(module.build(*graph, graph->add_input("f", {f.extent(0), f.extent(1), f.extent(2)})));
        }
        graph->write("f", {f.data(), f.size()});
        io->write(processor, key.pass, place.branch, frames);
        graph->run();
        io->record(processor, place.branch, frames);
        stack<float, 3> F(f.extents());
        graph->read({F.data(), F.size()});
        return F;
    }

    Module module;
    std::unique_ptr<typename graph_type::feature_io_type> io;
    std::map<adapters::graph_key, std::unique_ptr<graph_type>> graphs;
};

/// [GR eq. 3, 5, 6] A module equals the library's call in every pass, with each equation, a mask and a temperature, and
/// without.
template <class Module>
void check_every_pass() {
    for (auto const pre : {true, false}) {
        for (auto const post : {true, false}) {
            for (auto const keeps : {true, false}) {
                for (auto const power : {0.0, 1.0}) {
                    auto const apart =
                        compare_module<graph_module<Module>>({pre, post, keeps, feature_storage::same, power});
                    CHECK(apart.plain <= 1e-6);
                    CHECK(apart.keyframe <= 1e-6);
                    CHECK(apart.injected <= 1e-6);
                    CHECK(apart.second_step <= 1e-6);
                }
            }
        }
    }
}

/// Features in 16 bits differ from the library's by their rounding alone.
template <class Module>
void check_half_precision() {
    for (auto const storage : {feature_storage::f16, feature_storage::bf16}) {
        auto const apart = compare_module<graph_module<Module>>({true, true, false, storage});
        CHECK(apart.keyframe <= 1e-6);
        CHECK(apart.injected > 0);
        CHECK(apart.injected <= (storage == feature_storage::f16 ? 2e-3 : 2e-2));
    }
}

/// Runs that static graphs cannot do are refused before they begin.
template <class Graph>
void check_refused_runs(typename Graph::device_type const& device) {
    run_shapes shapes;
    CHECK_THROWS_WITH_AS(Graph::make_feature_io(device, shapes, {}), doctest::Contains("shapes.lists_sources"),
                         value_error);
    shapes.lists_sources = false;
    shapes.scales_logits = true;
    CHECK_THROWS_WITH_AS(Graph::make_feature_io(device, shapes, {}),
                         "graph_feature_io: shapes.scales_logits is true, expected a length_correction of 0 for graphs "
                         "that do not scale logits",
                         value_error);
    CHECK_NOTHROW(Graph::make_feature_io(device, shapes, {}, true));
    shapes.banks = 2;
    CHECK_THROWS_WITH_AS(Graph::make_feature_io(device, shapes, {}, true), doctest::Contains("one bank"), value_error);
}

/// Inputs go by name and must fit, also those that nothing reads; `twice(graph, x)` is 2 x.
template <class Graph, class Twice>
void check_inputs_and_output(typename Graph::device_type const& device, Twice const& twice) {
    run_shapes shapes;
    shapes.lists_sources = false;
    auto const io = Graph::make_feature_io(device, shapes, {});
    Graph graph(device, *io, {graph_pass::plain, 2, 0});
    auto const x = graph.add_input("x", {2, 3});
    graph.add_input("unread", {5});
    graph.finish(twice(graph, x));
    std::vector<float> values{1, -2, 3, 4, 5, 6};
    graph.write("unread", std::vector<float>(5));
    for (auto const run : {1, 2}) { // what a run leaves behind is of no account
        values[0] = static_cast<float>(run);
        graph.write("x", values);
        graph.run();
        std::vector<float> out(6);
        graph.read(out);
        CHECK(out == std::vector<float>{2 * values[0], -4, 6, 8, 10, 12});
    }
    std::vector<float> short_one(5);
    CHECK_THROWS_WITH_AS(graph.write("x", short_one), doctest::Contains("x.size() is 5, expected 6"), value_error);
    CHECK_THROWS_WITH_AS(graph.write("y", values), doctest::Contains("name is y"), value_error);
    CHECK_THROWS_WITH_AS(graph.read(short_one), doctest::Contains("output.size() is 6, expected 5"), value_error);
}

/// [EDM eq. 7] A denoiser whose network is F = c_in z + shift(channel, branch) gives c_skip z + c_out F, guided, in either
/// layout; `add(graph, a, b)` is a + b.
template <class Graph, class Add>
void check_denoiser(typename Graph::device_type const& device, Add const& add) {
    constexpr std::size_t channels = 3;
    constexpr grid_extents grid{2, 4};
    constexpr float sigma = 1.5f;
    constexpr float scale = 3;
    auto const shift_of = [](std::uint32_t branch, std::size_t c) {
        return static_cast<float>(c) + 0.25f * static_cast<float>(branch + 1);
    };
    std::vector<frame_index> const frames{{4}, {1}};
    auto const z = random_stack<float, 4>({frames.size(), channels, grid.height, grid.width}, 3);
    for (auto const layout : {adapters::latent_layout::channels_first, adapters::latent_layout::tokens}) {
        auto const is_tokens = layout == adapters::latent_layout::tokens;
        adapters::graph_network network{channels, grid, {}, prediction::velocity, {1 - scale, scale}, layout};
        adapters::graph_denoiser<Graph> const phi(
            device, network,
            [&](Graph& graph, typename Graph::tensor_type const& in) {
                std::vector<std::size_t> const shape =
                    is_tokens ? std::vector<std::size_t>{1, 1, channels} : std::vector<std::size_t>{1, channels, 1, 1};
                return add(graph, in, graph.add_input("shift", shape));
            },
            [&](Graph& graph, float level, std::span<frame_index const> of) {
                CHECK(level == sigma);
                CHECK(of.size() == frames.size());
                std::array<float, channels> shift{};
                for (std::size_t c = 0; c < channels; ++c) {
                    shift[c] = shift_of(graph.key().branch, c);
                }
                graph.write("shift", shift);
            });
        run_shapes shapes;
        shapes.lists_sources = false;
        phi.prepare(shapes);
        plain_attention processor;
        stack<float, 4> x0(z.extents());
        phi(x0.view(), z.view(), sigma, frames, processor);
        auto const [c_skip, c_out, c_in] = scalings_of(prediction::velocity, sigma);
        double greatest = 0;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            for (std::size_t c = 0; c < channels; ++c) {
                for (std::size_t t = 0; t < grid.size(); ++t) {
                    auto const at = z(i, c, t / grid.width, t % grid.width);
                    auto const F = c_in * at + (1 - scale) * shift_of(0, c) + scale * shift_of(1, c);
                    auto const found = x0(i, c, t / grid.width, t % grid.width);
                    greatest = std::max<double>(greatest, std::abs(c_skip * at + c_out * F - found));
                }
            }
        }
        CHECK(greatest <= 1e-5);
    }
}

} // namespace genrender::testing
