// SPDX-License-Identifier: MIT
// The library's side of the comparison, compiled once and without an engine.
#include "comparison.hpp"

#include "../scenes/camera_rotation.hpp"

#include <genrender/reference/reference_network.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/scene/rasterizer.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
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

/// A camera that goes around a still life, in pictures of `size` pixels a side.
engine_case case_of(std::filesystem::path const& folder, std::size_t size) {
    constexpr std::size_t frames = 8;
    constexpr std::size_t map_pixels = 4; // along a pixel of a picture
    auto const guidance = rasterize(scenes::camera_rotation(frames), {map_pixels * size, map_pixels * size});
    auto const inverse_depth = cell_means(sequence_inverse_depth(guidance.depth), {size, size});
    auto const weights = reference::reference_weights<float>::from_folder(folder);
    engine_case run{weights.config,
                    tensors_of(folder / "unet"),
                    tensors_of(folder / "controlnet"),
                    weights.conditioning(to_view(inverse_depth), "red stripes"),
                    guidance.uv,
                    {}};
    run.settings.steps = 4;
    run.settings.keyframes.count = 3;
    run.settings.frames_per_call = 3;
    run.settings.noise.seed = run.settings.keyframes.seed = 5;
    return run;
}

/// Seconds of the processor's time, which other programs of the machine do not lengthen.
double seconds_of(std::function<void()> const& work) {
    auto const start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// The greatest difference of two stacks, in parts of the range of the second.
double difference(latents<float> const& z, latents<float> const& reference) {
    require_extents("compare_engine", "z", z.shape(), reference.shape());
    double greatest = 0;
    for (std::size_t i = 0; i < z.size(); ++i) {
        auto const apart = std::abs(static_cast<double>(z.data()[i]) - static_cast<double>(reference.data()[i]));
        greatest = apart <= greatest ? greatest : apart; // what is not a number stays
    }
    auto const [low, high] = std::minmax_element(reference.begin(), reference.end());
    return greatest / (static_cast<double>(*high) - static_cast<double>(*low));
}

} // namespace

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
        std::filesystem::path const folder = GENRENDER_REFERENCE_DENOISER "/weights";
        double greatest = 0;
        double least_effect = 1;
        std::string times;
        std::string shares;
        for (auto const size : {std::size_t{64}, std::size_t{128}}) {
            auto const given = case_of(folder, size);
            auto source = reference::reference_weights<float>::from_folder(folder);
            reference_network<float> const network(source, given.conditioning);
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
