// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi as a static graph] A denoiser builds each graph once, writes before it runs and reads behind it.
#include <genrender/adapters/graph_denoiser.hpp>

#include "numbered_memory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("adapters/graph_denoiser") {
    namespace {

    /// What happened, in a vector that outlives all graphs.
    using diary = std::vector<std::string>;

    /// A graph whose output is its input: says what is done to it.
    struct diary_graph {
        using device_type = diary*;
        using tensor_type = std::string;
        using feature_io_type = numbered_feature_io;
        static std::unique_ptr<numbered_feature_io> make_feature_io(diary* happened, run_shapes const& shapes,
                                                                    std::span<attention_site const> sites,
                                                                    bool scales_logits) {
            happened->push_back("tensors");
            return std::make_unique<numbered_feature_io>(numbered_memory{}, shapes, sites, scales_logits);
        }

        diary* happened;
        adapters::graph_key of;
        std::vector<float> z{};
        diary_graph(diary* to, numbered_feature_io&, adapters::graph_key key) : happened(to), of(key) {}
        adapters::graph_key key() const { return of; }
        std::string add_input(std::string const& name, std::vector<std::size_t> const& shape) {
            std::string text = name;
            for (auto const n : shape) {
                text += ' ' + std::to_string(n);
            }
            happened->push_back("input " + text);
            return text;
        }
        void finish(std::string const& output) { happened->push_back("finish " + output); }
        void write(std::string const& name, std::span<float const> values) {
            happened->push_back("write " + name);
            z.assign(values.begin(), values.end());
        }
        void run() { happened->push_back("run " + std::to_string(of.branch)); }
        void read(std::span<float> values) const { std::copy(z.begin(), z.end(), values.begin()); }
    };

    using diary_denoiser = adapters::graph_denoiser<diary_graph>;
    static_assert(preparable_denoiser<diary_denoiser>);

    adapters::graph_network small_network() {
        adapters::graph_network network;
        network.latent_channels = 1;
        network.latent_grid = {2, 2};
        network.branch_weights = {-0.5f, 1.5f};
        return network;
    }

    diary_denoiser denoiser_of(diary& happened, adapters::graph_network const& network) {
        return {
            &happened, network,
            [](diary_graph& graph, std::string const& z) {
                return "of pass " + std::to_string(static_cast<int>(graph.key().pass)) + " over " + z;
            },
            [](diary_graph& graph, float, std::span<frame_index const>) { graph.happened->push_back("own inputs"); }};
    }

    run_shapes shapes_without_places() {
        run_shapes shapes;
        shapes.lists_sources = false;
        return shapes;
    }

    } // namespace

    TEST_CASE("a graph is built for the first call of its kind and written before every run") {
        diary happened;
        auto const phi = denoiser_of(happened, small_network());
        phi.prepare(shapes_without_places());
        plain_attention processor;
        std::array const z{4.0f, 3.0f, 2.0f, 1.0f};
        std::array<float, 4> x0{};
        std::vector<frame_index> const frame{{3}};
        auto const call = [&] {
            phi(strided_view<float, 4>(x0.data(), {1, 1, 2, 2}), strided_view<float const, 4>(z.data(), {1, 1, 2, 2}),
                2.0f, frame, processor);
        };
        call();
        diary const built_once{"tensors", "input z 1 1 2 2", "finish of pass 0 over z 1 1 2 2", "write z", "own inputs",
                               "run 0",   "input z 1 1 2 2", "finish of pass 0 over z 1 1 2 2", "write z", "own inputs",
                               "run 1"};
        CHECK(happened == built_once);
        happened.clear();
        call();
        CHECK(happened == diary{"write z", "own inputs", "run 0", "write z", "own inputs", "run 1"});
        // F = c_in z in both branches, whose weights sum to 1: z - sigma F.
        auto const c_in = 1 / std::sqrt(5.0f);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(x0[i] == doctest::Approx(z[i] * (1 - 2 * c_in)));
        }
        happened.clear();
        phi.prepare(shapes_without_places());
        call();
        CHECK(std::count(happened.begin(), happened.end(), "finish of pass 0 over z 1 1 2 2") == 2);
    }

    TEST_CASE("a run that scales logits is refused unless the network says that it does") {
        diary happened;
        auto network = small_network();
        auto shapes = shapes_without_places();
        shapes.scales_logits = true;
        CHECK_THROWS_WITH_AS(denoiser_of(happened, network).prepare(shapes),
                             "graph_feature_io: shapes.scales_logits is true, expected a length_correction of 0 for "
                             "graphs that do not scale logits",
                             value_error);
        network.scales_logits = true;
        CHECK_NOTHROW(denoiser_of(happened, network).prepare(shapes));
    }

    TEST_CASE("tokens lie one after the other with their channels innermost") {
        std::vector<float> values(2 * 3 * 4);
        auto const view = adapters::latents_view(values.data(), adapters::latent_layout::tokens, 2, 3, {2, 2});
        CHECK(&view(1, 2, 1, 0) == values.data() + 1 * 12 + 2 * 3 + 2);
        auto const plain = adapters::latents_view(values.data(), adapters::latent_layout::channels_first, 2, 3, {2, 2});
        CHECK(&plain(1, 2, 1, 0) == values.data() + 1 * 12 + 2 * 4 + 2);
    }

    TEST_CASE("a call before prepare, and a network without latents, branches or functions, are refused") {
        diary happened;
        auto const phi = denoiser_of(happened, small_network());
        plain_attention processor;
        std::vector<frame_index> const frame{{0}};
        std::array<float, 4> x0{};
        strided_view<float, 4> const view(x0.data(), {1, 1, 2, 2});
        CHECK_THROWS_WITH_AS(phi(view, view, 1.0f, frame, processor), doctest::Contains("expected prepare(shapes)"),
                             value_error);
        auto network = small_network();
        network.branch_weights.clear();
        CHECK_THROWS_WITH_AS(denoiser_of(happened, network), doctest::Contains("network.branch_weights is empty"),
                             value_error);
        network.latent_grid = {};
        CHECK_THROWS_WITH_AS(denoiser_of(happened, network), doctest::Contains("network is without latents"),
                             value_error);
        CHECK_THROWS_WITH_AS(diary_denoiser(&happened, small_network(), nullptr, nullptr),
                             doctest::Contains("build, write is empty"), value_error);
    }
}
