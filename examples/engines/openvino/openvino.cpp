// SPDX-License-Identifier: MIT
// OpenVINO behind genrender: what it takes beside the network, compared with plain loops.
#include "network.hpp"

#include "../static_graph/comparison.hpp"

#include <genrender/pipeline/render.hpp>

using namespace genrender;
using namespace genrender::examples;

int main() {
    std::string const version = ov::get_openvino_version().buildNumber;
    return compare_graphs("OpenVINO " + version.substr(0, version.find('-')), [](graph_case const& given) {
        // docs:begin openvino_denoiser
        small_unet const net;
        adapters::openvino_device device;
        device.properties.insert(ov::inference_num_threads(1));
        adapters::graph_network const network{.latent_channels = net.latent_channels,
                                              .latent_grid = net.grid,
                                              .sites = {net.sites.begin(), net.sites.end()},
                                              .predicted = prediction::velocity,
                                              .branch_weights = {0.5f, 0.5f},
                                              .layout = adapters::latent_layout::tokens,
                                              .scales_logits = true};
        auto const build = [&](adapters::openvino_graph& graph, adapters::openvino_value const& z) {
            openvino_operations operations{graph};
            return net(operations, z, graph.add_input("shift", {1, 1, net.channels}));
        };
        auto const write = [](adapters::openvino_graph& graph, float sigma, std::span<frame_index const>) {
            graph.write("shift", small_unet::shift(sigma, graph.key().branch));
        };
        adapters::openvino_denoiser const phi(device, network, build, write);
        auto run = render(phi, to_uv_view(given.UV), {.settings = given.settings});
        // docs:end
        return graph_frames{std::move(run.z), std::move(run.report)};
    });
}
