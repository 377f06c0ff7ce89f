// SPDX-License-Identifier: MIT
// The report of a run, as JSON.
#pragma once

#include "guidance_source.hpp"
#include "names.hpp"
#include "render_options.hpp"
#include "render_output.hpp"

#include <genrender/core/error.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/evaluation/correspondence_error.hpp>
#include <genrender/evaluation/pixel_correspondence.hpp>
#include <genrender/pipeline/render_report.hpp>

#include <nlohmann/json.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace genrender::examples {

/// Time since it was made.
class stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(clock::now() - start_).count(); }

private:
    using clock = std::chrono::steady_clock;
    clock::time_point start_ = clock::now();
};

/// Seconds by the clock on the wall: in total, in the denoiser (attention and mixing included), in the rest of the
/// library, and in everything else: reading, rasterising, decoding and writing.
inline nlohmann::ordered_json seconds_of(render_report const& report, double total) {
    auto const denoiser = report.denoiser_seconds;
    auto const library = report.library_seconds;
    return {{"total", total}, {"denoiser", denoiser}, {"library", library}, {"other", total - denoiser - library}};
}

/// The name of a method for a picture's label.
inline std::string method_name(std::string_view method) {
    return method == "generative_rendering" ? "genrender" : method == "per_frame" ? "per frame" : std::string(method);
}

/// The run in folder `earlier`, as far as a run of `frames` frames of `image` extents into `out` is compared with it.
/// Throws file_error if it has no report or not these frames, value_error if it is `out` itself.
inline earlier_run load_earlier_run(std::filesystem::path const& earlier, std::filesystem::path const& out,
                                    std::size_t frames, grid_extents image) {
    auto const path = earlier / "report.json";
    std::ifstream stream(path);
    auto const json = nlohmann::json::parse(stream, nullptr, false);
    if (!stream || !json.is_object() || !json.contains("method") || !json["method"].is_string()) {
        throw file_error(path.string() + ": is no report of a run, expected the folder of an earlier one");
    }
    require_value(!std::filesystem::equivalent(earlier, out), "--beside", "folder", earlier.string(),
                  "another folder than --out");
    earlier_run run{method_name(json["method"].get<std::string>()), {}};
    for (std::size_t i = 0; i < frames; ++i) {
        auto const frame_path = earlier / "frames" / numbered_name(i);
        run.frames.push_back(read_png(frame_path));
        if (run.frames.back().grid() != image) {
            throw file_error(frame_path.string() + ": the frame is " +
                             extents_text({run.frames.back().height, run.frames.back().width}) + ", expected " +
                             extents_text({image.height, image.width}));
        }
    }
    return run;
}

/// What report.json says of a run, whose maps are cut to what is shown, but its times: settings, memory, coverage, correspondence error, notes.
inline nlohmann::ordered_json report_of(render_options const& options, guidance_source const& source,
                                        render_report const& report, tensor<float, 4> const& images) {
    nlohmann::ordered_json json;
    auto const& settings = options.settings;
    json["method"] = name_in(method_names, options.method);
    auto& told = json["settings"];
    told["input"] = !options.scene.empty()   ? options.scene
                    : !options.model.empty() ? options.model.string()
                                             : options.maps.string();
    told["prompt"] = options.prompt.text;
    told["negative_prompt"] = options.prompt.negative;
    told["guidance"] = options.prompt.guidance_scale ? nlohmann::ordered_json(*options.prompt.guidance_scale) : nullptr;
    told["pipeline"] = options.pipeline.string();
    told["engine"] = options.engine.string();
    told["frames"] = images.shape()[0];
    told["size"] = {source.extents.shown.height, source.extents.shown.width};
    told["rendered_size"] = {source.extents.rendered.height, source.extents.rendered.width};
    told["frames_per_second"] = source.frames_per_second;
    told["map_size"] = {source.guidance.uv.grid().height, source.guidance.uv.grid().width};
    told["steps"] = settings.steps;
    told["sampler"] = name_in(sampler_names, settings.sampler);
    told["seed"] = options.seed;
    told["vectors"] = name_of(report.kernels);
    told["noise"] = name_in(noise_names, settings.noise.kind);
    auto const& matched = options.correspondence;
    if (settings.noise.kind == noise_kind::uv) {
        told["noise_reading"] = matched.noise;
        told["background"] = matched.background;
    }
    if (options.method != render_method::per_frame) {
        told["temperature"] = settings.injection.length_correction;
    }
    if (options.method == render_method::generative_rendering || options.method == render_method::tokenflow) {
        told["keyframes"] = settings.keyframes.count;
    }
    if (options.method == render_method::generative_rendering) {
        told["canonical"] = matched.canonical;
        told["correspondence"] = matched.correspondence;
        auto const& injected = options.injection;
        told["average"] = name_in(correspondence_options::average_names, settings.average);
        told["quality_exponent"] = {settings.quality.exponent_begin, settings.quality.exponent_end};
        told["quality_threshold"] = settings.quality.threshold;
        told["preset"] = injected.preset;
        told["alpha"] = injected.alpha;
        told["latents_grid_alpha"] = settings.latents_grid_alpha;
        told["alpha_schedule"] = injected.schedule;
        told["keyframe_drawing"] = injected.drawing;
        told["counts_points"] = settings.injection.counts_points;
        told["variance"] = name_in(injection_options::variance_names, settings.injection.variance.target);
        told["feature_storage"] = name_in(storage_names, settings.keyframe_storage);
        told["pre_attention"] = settings.injection.pre_attention;
        told["post_attention"] = settings.injection.post_attention;
    }
    told["normalization"] = settings.normalization.enabled
                                ? name_in(consistency_options::statistics_names, settings.normalization.statistics)
                                : "none";
    told["normalization_target"] = name_in(consistency_options::target_names, settings.normalization.target);
    told["consensus"] = settings.consensus.enabled;
    if (settings.consensus.enabled) {
        told["consensus_window"] = {settings.consensus.window_begin, settings.consensus.window_end};
        told["consensus_sources"] = std::min<std::size_t>(settings.consensus.sources.count, images.shape()[0]);
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    json["peak_resident_bytes"] = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
    json["coverage"] = nlohmann::ordered_json::object();
    for (auto const& [grid, count] : report.coverage) {
        json["coverage"][std::to_string(grid.height) + "x" + std::to_string(grid.width)] = count.share();
    }
    if (report.consensus.on_objects > 0) {
        json["consensus_coverage"] = report.consensus.share();
    }
    pixel_correspondence const pixels(to_uv_view(source.guidance.uv), source.extents.shown);
    json["correspondence_error"] = nlohmann::ordered_json::object();
    for (std::size_t const interval : {1U, 5U, 10U}) {
        auto const error = correspondence_error(to_view(images), pixels, interval);
        json["correspondence_error"][std::to_string(interval)] =
            error ? nlohmann::ordered_json(*error) : nlohmann::ordered_json(nullptr);
    }
    json["frames_without_background"] = report.skipped_frames;
    json["notes"] = source.notes;
    return json;
}

} // namespace genrender::examples
