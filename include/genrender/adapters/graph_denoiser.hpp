// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi as a static graph] A denoiser of static graphs, of which an engine's author writes the network alone.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/adapters/graph_feature_io.hpp>
#include <genrender/attention/attention_site.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/linear_combination.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/injection/feature_io.hpp>
#include <genrender/sampling/preconditioning.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace genrender::adapters {

/// How the numbers of latents lie in the input and the output of a graph.
enum class latent_layout : std::uint8_t {
    channels_first, ///< [frames, channels, height, width]
    tokens          ///< [frames, height * width, channels]
};

/// What is known of a network before it is built.
struct graph_network {
    std::size_t latent_channels = 0;            ///< channels of z
    grid_extents latent_grid;                   ///< height and width of z
    std::vector<attention_site> sites;          ///< self-attention modules, in the order of site_index
    prediction predicted = prediction::epsilon; ///< what the network's output stands for
    std::vector<float> branch_weights = {1.0F}; ///< of each branch's output; {1 - s, s} is guidance of scale s
    latent_layout layout = latent_layout::channels_first; ///< of the graphs' input and output
    bool scales_logits = false; ///< whether every module takes `site.scaled` of its queries; else such runs are refused
};

/// A view [frames, channels, height, width] of latents that lie in a graph's layout.
inline strided_view<float, 4> latents_view(float* values, latent_layout layout, std::size_t frames,
                                           std::size_t channels, grid_extents grid) {
    if (layout == latent_layout::channels_first) {
        return {values, {frames, channels, grid.height, grid.width}};
    }
    auto const token = static_cast<std::ptrdiff_t>(channels);
    auto const row = token * static_cast<std::ptrdiff_t>(grid.width);
    return {values,
            {frames, channels, grid.height, grid.width},
            {row * static_cast<std::ptrdiff_t>(grid.height), 1, row, token}};
}

/// A preparable_denoiser of an engine's static graphs: builds one for each pass, stack of frames and branch when it is
/// first needed, writes scaled latents and what else the network takes, runs it between `write` and `record` of the
/// engine's feature I/O, and makes the clean estimate of the outputs of all branches. Calls take turns; set
/// `settings.calls_at_once` to 1. Copies share graphs. A Graph is an adapter's, ggml_graph or openvino_graph:
///
/// expression                             | type          | meaning
/// ---------------------------------------|---------------|----------------------------------------------------------
/// `typename Graph::device_type`          | copyable      | where graphs run
/// `typename Graph::tensor_type`          | copyable      | a value of a graph under construction
/// `typename Graph::feature_io_type`      |               | a graph_feature_io
/// `Graph::make_feature_io(device, shapes,| a unique_ptr  | the fixed tensors of a run
///  sites, scales_logits)`                |               |
/// `Graph(device, io, key)`               | Graph         | one without nodes, for a graph_key; outlived by io
/// `graph.add_input(name, shape)`         | `tensor_type` | a float input of a row-major shape, its last axis innermost
/// `graph.finish(output)`                 | any           | no node comes any more; output is what `read` reads
/// `graph.write("z", values)`             | any           | writes an input, a span of floats; before every run
/// `graph.run()`, `graph.read(values)`    | any           | runs it, copies its output into a span of floats
template <class Graph>
class graph_denoiser {
public:
    using real_type = float;                                       ///< of latents
    using feature_io_type = typename Graph::feature_io_type;       ///< of the engine
    using features_type = typename feature_io_type::features_type; ///< handle of features
    using tensor_type = typename Graph::tensor_type;               ///< a value of a graph
    using device_type = typename Graph::device_type;               ///< where graphs run
    /// Builds the network over c_in z of graph_network::layout, asks graph.site(index) for what goes around each
    /// self-attention module, adds the inputs that it needs besides, and gives the output, of z's shape.
    using build_type = std::function<tensor_type(Graph&, tensor_type const& z)>;
    /// Writes those inputs for a noise level and these frames, before every run; graph.key() tells the branch.
    using write_type = std::function<void(Graph&, float sigma, std::span<frame_index const> frames)>;

    /// Throws value_error if the network has no latents or no branch, or `build` or `write` is empty.
    graph_denoiser(device_type device, graph_network network, build_type build, write_type write)
        : state_(std::make_shared<state>(std::move(device), std::move(network), std::move(build), std::move(write))) {
        auto const& told = state_->network;
        constexpr auto here = "graph_denoiser";
        require_value(told.latent_channels > 0 && told.latent_grid.size() > 0, here, "network", "without latents",
                      "channels and a grid");
        require_value(!told.branch_weights.empty(), here, "network.branch_weights", "empty", "one for each branch");
        require_value(state_->build && state_->write, here, "build, write", "empty", "functions");
    }

    /// Channels of z.
    std::size_t latent_channels() const { return state_->network.latent_channels; }
    /// Height and width of z.
    grid_extents latent_grid() const { return state_->network.latent_grid; }
    /// The self-attention modules.
    std::span<attention_site const> sites() const { return state_->network.sites; }
    /// Guidance branches.
    std::size_t branches() const { return state_->network.branch_weights.size(); }

    /// Makes the fixed tensors of a run; graphs of an earlier one are gone. Throws as graph_feature_io does.
    void prepare(run_shapes const& shapes) const {
        state_->graphs.clear();
        state_->io.reset();
        auto const& network = state_->network;
        state_->io = Graph::make_feature_io(state_->device, shapes, network.sites, network.scales_logits);
    }

    /// The clean estimate x0 of z, both [frames, channels, height, width], as denoiser says. Throws value_error before
    /// `prepare`, and what graphs throw.
    template <feature_io_processor<features_type, float> Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const {
        auto const& network = state_->network;
        require_value(state_->io != nullptr, "graph_denoiser", "shapes", "unknown",
                      "prepare(shapes) before the first call");
        auto& io = *state_->io;
        auto const lock = io.lock();
        auto const pass = io.pass_of(processor, frames);
        auto const view = [&](std::vector<float>& values) {
            return latents_view(values.data(), network.layout, frames.size(), latent_channels(), latent_grid());
        };
        std::vector<float> in(z.size());
        std::vector<float> out(z.size());
        std::vector<float> F(z.size());
        linear_combination<float, 4, 1>(view(in), {scalings_of(network.predicted, sigma).c_in}, {z});
        for (std::uint32_t branch = 0; branch < branches(); ++branch) {
            auto& graph = graph_of({pass, frames.size(), branch});
            graph.write("z", in);
            state_->write(graph, sigma, frames);
            io.write(processor, pass, branch, frames);
            graph.run();
            io.record(processor, branch, frames);
            graph.read(out);
            auto const weight = network.branch_weights[branch];
            std::transform(F.begin(), F.end(), out.begin(), F.begin(),
                           [weight](float sum, float of_branch) { return sum + weight * of_branch; });
        }
        to_clean(x0, network.predicted, z, view(F), sigma);
    }

private:
    struct state {
        state(device_type on, graph_network told, build_type builds, write_type writes)
            : device(std::move(on)), network(std::move(told)), build(std::move(builds)), write(std::move(writes)) {}
        device_type device;
        graph_network network;
        build_type build;
        write_type write;
        std::unique_ptr<feature_io_type> io;
        std::map<graph_key, std::unique_ptr<Graph>> graphs;
    };

    Graph& graph_of(graph_key key) const {
        auto& kept = state_->graphs[key];
        if (kept == nullptr) {
            auto made = std::make_unique<Graph>(state_->device, *state_->io, key);
            auto const channels = latent_channels();
            auto const [height, width] = latent_grid();
            auto const z = state_->network.layout == latent_layout::tokens
                               ? made->add_input("z", {key.frames, height * width, channels})
                               : made->add_input("z", {key.frames, channels, height, width});
            made->finish(state_->build(*made, z));
            kept = std::move(made);
        }
        return *kept;
    }

    std::shared_ptr<state> state_;
};

} // namespace genrender::adapters

#include <genrender/core/end_header.inl>
