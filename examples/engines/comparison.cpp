// SPDX-License-Identifier: MIT
// The library's side of the comparison, compiled once and without an engine.
#include "comparison.hpp"

#include "../scenes/camera_rotation.hpp"
#include "measures.hpp"

#include <genrender/reference/pipeline_files.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/stable_diffusion.hpp>
#include <genrender/scene/rasterizer.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <utility>

namespace genrender::examples {

namespace {

named_tensors tensors_of(std::filesystem::path const& folder) {
    reference::safetensors_file const file((folder / "diffusion_pytorch_model.safetensors").string());
    named_tensors tensors;
    for (auto const& [name, entry] : file.entries()) {
        tensors[name] = {entry.shape, file.read<float>(name)};
    }
    return tensors;
}

} // namespace

engine_case case_of_size(std::size_t size) {
    constexpr std::size_t frames = 8;
    constexpr std::size_t map_pixels = 4; // along a pixel of a picture
    std::filesystem::path const folder = GENRENDER_MINIATURE_WEIGHTS;
    auto const guidance = rasterize(scenes::camera_rotation(frames), {map_pixels * size, map_pixels * size});
    auto const inverse_depth = cell_means(sequence_inverse_depth(guidance.depth), {size, size});
    reference::stable_diffusion<float> const pipeline{reference::pipeline_files(folder)};
    engine_case run{folder,
                    pipeline.config(),
                    tensors_of(folder / "unet"),
                    tensors_of(folder / "controlnet"),
                    pipeline.conditioning(to_view(inverse_depth), {.text = "a red ball on a green checkered ground",
                                                                   .negative = "at night",
                                                                   .guidance_scale = 3}),
                    guidance.uv};
    run.settings.steps = 4;
    run.settings.sigma_min = static_cast<float>(pipeline.schedule().sigma_min());
    run.settings.sigma_max = static_cast<float>(pipeline.schedule().sigma_max());
    run.settings.keyframes.count = 3;
    run.settings.frames_per_call = 3;
    run.settings.noise.seed = run.settings.keyframes.seed = 5; // Python takes one for both
    return run;
}

int compare_engine(std::string_view engine, std::string_view way_in, double bound,
                   std::function<render_result<float>(engine_case const&)> const& run) {
    return compare_frames(engine, way_in, bound, [&](engine_case const& given) {
        engine_frames frames;
        frames.seconds = seconds_of([&] {
            auto result = run(given);
            frames.z = std::move(result.z);
            frames.report = std::move(result.report);
        });
        return frames;
    });
}

int compare_frames(std::string_view engine, std::string_view way_in, double bound,
                   std::function<engine_frames(engine_case const&)> const& run) {
    try {
        double greatest = 0;
        double least_effect = 1;
        std::string times;
        std::string shares;
        for (auto const size : {std::size_t{64}, std::size_t{128}}) {
            auto const given = case_of_size(size);
            auto const network =
                reference::stable_diffusion<float>{reference::pipeline_files(given.folder)}.network(given.conditioning);
            auto const rendered = [&](render_settings<float> const& settings) {
                return genrender::render(network, to_uv_view(given.UV), {.settings = settings}).z;
            };
            latents<float> reference;
            auto const reference_seconds = seconds_of([&] { reference = rendered(given.settings); });
            auto const frames = run(given);
            greatest = std::max(greatest, difference(frames.z, reference));
            if (size == 64) {
                auto plain = given.settings;
                plain.injection.pre_attention = plain.injection.post_attention = false;
                least_effect = difference(rendered(plain), reference);
            }
            auto const& report = frames.report;
            auto const share = 100 * report.library_seconds / (report.library_seconds + report.denoiser_seconds);
            char text[96];
            std::snprintf(text, sizeof text, "%s%.2f / %.2f (%zu px)", times.empty() ? "" : ", ", frames.seconds,
                          reference_seconds, size);
            times += text;
            std::snprintf(text, sizeof text, "%s%.1f %%", shares.empty() ? "" : ", ", share);
            shares += text;
        }
        std::printf("%.*s | %.*s | - | - | %.1e | %s | %s\n", static_cast<int>(engine.size()), engine.data(),
                    static_cast<int>(way_in.size()), way_in.data(), greatest, times.c_str(), shares.c_str());
        if (!(greatest <= bound)) {
            std::fprintf(stderr, "frames differ by %g of their range, expected at most %g\n", greatest, bound);
            return 1;
        }
        if (!(least_effect >= 100 * bound)) {
            std::fprintf(stderr, "injection moves frames by %g of their range, expected %g to tell it from none\n",
                         least_effect, 100 * bound);
            return 1;
        }
        return 0;
    } catch (std::exception const& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}

} // namespace genrender::examples
