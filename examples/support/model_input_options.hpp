// SPDX-License-Identifier: MIT
// The command line's options of time and of models: which animation, which frames of it, and who looks.
#pragma once

#include "model_file.hpp"

#include <CLI/CLI.hpp>

#include <cstddef>
#include <numbers>
#include <optional>
#include <string>

namespace genrender::examples {

/// What is told of a model file, and of the time of any input.
struct model_input_options {
    std::optional<long> start;
    std::optional<long> end;
    std::optional<double> frames_per_second;
    std::string animation;
    std::string camera; ///< of the file, or "fit"
    std::optional<double> azimuth;
    std::optional<double> elevation;
    std::string up = "file";
    std::size_t uv_set = 0;
    bool makes_atlas = false;

    /// Adds the options.
    void add_to(CLI::App& app) {
        auto* const time = app.add_option_group("Time", "which frames are rendered");
        time->add_option("--start", start, "first frame: of the files' numbers, or of a model's time line")
            ->type_name("F");
        time->add_option("--end", end, "last frame")->type_name("F");
        time->add_option("--fps", frames_per_second,
                         "frames a second: of a model those that are rendered, and of the moving pictures")
            ->check(CLI::Range(0.01, 1000.0).description(""))
            ->type_name("RATE");
        auto* const of_model = app.add_option_group("Of a model", "with --model");
        of_model_ = of_model;
        of_model
            ->add_option("--animation", animation,
                         "name or number of an animation of the file, or all (all together where they move different\n"
                         "things, else the longest)")
            ->type_name("NAME|N|all");
        of_model
            ->add_option(
                "--camera", camera,
                "a camera of the file, or fit: one that sees all frames (the file's first that shows the model)")
            ->type_name("NAME|fit");
        of_model->add_option("--azimuth", azimuth, "where the fitted camera stands: 0 in front, 90 to the right (29)")
            ->check(CLI::Range(-360.0, 360.0).description(""))
            ->type_name("DEG");
        of_model->add_option("--elevation", elevation, "and how high: 0 on the ground, up to 89 above (17)")
            ->check(CLI::Range(-89.0, 89.0).description(""))
            ->type_name("DEG");
        of_model->add_option("--up", up, "the axis that points up: y, z, or what the file says")
            ->check(CLI::IsMember({"file", "y", "z"}).description(""))
            ->type_name("AXIS");
        auto* const set = of_model->add_option("--uv-set", uv_set, "which of a mesh's sets of texture coordinates")
                              ->capture_default_str()
                              ->check(CLI::Range(0, 7).description(""))
                              ->type_name("N");
        of_model->add_flag("--atlas", makes_atlas, "new texture coordinates, where no two places share a texel")
            ->excludes(set);
    }

    /// Throws CLI::ValidationError for options that the input, of which one is told, does not have.
    void require_input(bool is_model, bool is_scene) const {
        if (!is_model && of_model_->count_all() > 0) {
            throw CLI::ValidationError("--animation, --camera, --azimuth, --elevation, --up, --uv-set and --atlas",
                                       "are of --model");
        }
        if (is_scene && (start || end)) {
            throw CLI::ValidationError("--start and --end", "are of --model and --maps");
        }
    }

    /// The options of a model; `width_over_height` where both sides of the frames are told.
    model_options of_model(std::optional<std::size_t> frames, std::optional<float> width_over_height) const {
        constexpr auto radians = std::numbers::pi / 180;
        model_options options;
        options.time = {.frames = frames.value_or(0),
                        .frames_at_rest = frames.value_or(24),
                        .frames_per_second = frames_per_second,
                        .start = start,
                        .end = end,
                        .animation = animation};
        options.aspect = width_over_height;
        auto const is_fitted = camera == "fit" || azimuth || elevation;
        options.view = !is_fitted ? (camera.empty() ? model_view::automatic : model_view::file) : model_view::fitted;
        options.camera = is_fitted ? "" : camera;
        options.azimuth = azimuth ? static_cast<float>(*azimuth * radians) : options.azimuth;
        options.elevation = elevation ? static_cast<float>(*elevation * radians) : options.elevation;
        options.up = up == "y" ? model_up::y : up == "z" ? model_up::z : model_up::from_file;
        options.uvs = makes_atlas ? model_uvs::atlas : model_uvs::from_file;
        options.uv_set = uv_set;
        return options;
    }

private:
    CLI::App const* of_model_ = nullptr; ///< while the command line is read
};

} // namespace genrender::examples
