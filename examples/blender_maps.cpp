// SPDX-License-Identifier: MIT
// A built-in scene as the folder of EXR files that Blender's Cycles writes: what `generative_rendering --maps` reads.
#include "scenes/scenes.hpp"
#include "support/exr_maps_writer.hpp"

#include <genrender/scene/rasterizer.hpp>

#include <cstdio>
#include <exception>
#include <string>

using namespace genrender;

int main(int argc, char** argv) try {
    if (argc < 3) {
        std::fprintf(
            stderr,
            "blender_maps SCENE FOLDER [FRAMES] [HEIGHT] [WIDTH]: scenes are camera_rotation, bouncing_balls and "
            "walking_figure\n");
        return 2;
    }
    std::size_t const frames = argc > 3 ? std::stoul(argv[3]) : 8;
    std::size_t const height = argc > 4 ? std::stoul(argv[4]) : 256;
    std::size_t const width = argc > 5 ? std::stoul(argv[5]) : height;
    auto const guidance =
        rasterize(scenes::make_scene(argv[1], frames), {height, width}, threaded_loop(), position_pass::on);

    // Channels ViewLayer.UV.U/V/A, ViewLayer.Depth.Z, ViewLayer.IndexOB.X and the rest position as
    // ViewLayer.Rest.X/Y/Z, which Blender writes as an output variable of a shader, in 32 bits; v upwards, background
    // at depth 1e10.
    auto const files = examples::write_exr_maps(argv[2], guidance.uv, guidance.depth, {}, guidance.position);
    std::printf("%zu files, the first is %s\n", files.size(), files.front().c_str());
} catch (std::exception const& error) {
    std::fprintf(stderr, "blender_maps: %s\n", error.what());
    return 1;
}
