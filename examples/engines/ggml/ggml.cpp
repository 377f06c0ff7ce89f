// SPDX-License-Identifier: MIT
// ggml behind genrender: what it takes beside the network, compared with plain loops.
#include "network.hpp"

#include "../static_graph/comparison.hpp"

#include <genrender/pipeline/render.hpp>

#include <ggml-cpu.h>

using namespace genrender;
using namespace genrender::examples;

int main() {
    return compare_graphs(std::string("ggml ") + ggml_version(), [](graph_case const& given) {
        // docs:begin ggml_denoiser
        small_unet const net;
        ggml_backend_ptr const backend(ggml_backend_cpu_init());
        ggml_backend_cpu_set_n_threads(backend.get(), 1);
        ggml_weights const weights(backend.get(), net);
        adapters::graph_network const network{.latent_channels = net.latent_channels,
                                              .latent_grid = net.grid,
                                              .sites = {net.sites.begin(), net.sites.end()},
                                              .predicted = prediction::velocity,
                                              .branch_weights = {0.5f, 0.5f},
                                              .layout = adapters::latent_layout::tokens,
                                              .scales_logits = true};
        auto const build = [&](adapters::ggml_graph& graph, ggml_tensor* z) {
            ggml_operations operations{graph, weights};
            return net(operations, z, graph.add_input("shift", {net.channels}));
        };
        auto const write = [](adapters::ggml_graph& graph, float sigma, std::span<frame_index const>) {
            graph.write("shift", small_unet::shift(sigma, graph.key().branch));
        };
        adapters::ggml_denoiser const phi({backend.get()}, network, build, write);
        auto run = render(phi, to_uv_view(given.UV), {.settings = given.settings});
        // docs:end
        return graph_frames{std::move(run.z), std::move(run.report)};
    });
}
