// SPDX-License-Identifier: MIT
// [GR alg. 1] The shortest whole program: a scene, a denoiser, consistent latents.
#include "scenes/camera_rotation.hpp"

#include <genrender/scene/rasterizer.hpp>
#include <genrender/reference/stable_diffusion.hpp>

#include <exception>

// docs:begin first_render
#include <genrender/genrender.hpp>

#include <iostream>
#include <utility>

/// Consistent latents of all frames of an animation, for your decoder.
template <genrender::denoiser Phi>
genrender::latents<float> stylise(Phi const& your_network, genrender::uv_maps const& UV) {
    genrender::render_settings<float> settings;
    settings.steps = 4;
    settings.keyframes.count = 2;
    settings.noise.seed = 7;

    auto const show = [](genrender::progress const& now) {
        std::cerr << "step " << now.step + 1 << ", " << now.remaining_seconds << " s left\r";
        return true; // false ends the run
    };
    auto result = genrender::render(your_network, to_uv_view(UV), {.settings = settings, .observer = show});
    for (auto const& [grid, coverage] : result.report.coverage) {
        std::cout << grid.height << "x" << grid.width << ": keyframes cover " << 100 * coverage.share() << " %\n";
    }
    return std::move(result.z);
}
// docs:end

int main() {
    try {
        auto const guidance = genrender::rasterize(genrender::scenes::camera_rotation(4), {128, 128});
        auto const nearness = genrender::cell_means(genrender::sequence_inverse_depth(guidance.depth), {64, 64});
        // docs:begin pipeline_of_a_folder
        genrender::reference::pipeline_files const files(GENRENDER_MINIATURE "/weights"); // or yours
        genrender::reference::stable_diffusion<float> const pipeline(files);
        auto const network = pipeline.network(pipeline.conditioning(to_view(nearness), {.text = "a red dotted ball"}));
        auto const z = stylise(network, guidance.uv);
        auto const pictures = pipeline.pictures(to_view(z)); // [frames, 3, height, width]
        // docs:end
        return pictures.extent(0) == 4 ? 0 : 1;
    } catch (std::exception const& error) {
        std::cerr << error.what() << "\n";
        return 1;
    }
}
