// SPDX-License-Identifier: MIT
// The row of a client in Python: gives it the run by files, lets it render in a process of its own and compares.
//
//     client_<engine> [folder for files]
#include "../comparison.hpp"

#include <genrender/core/error.hpp>
#include <genrender/reference/safetensors.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

using namespace genrender;
using namespace genrender::examples;

namespace {

template <std::size_t Rank>
reference::safetensors_source source_of(stack<float, Rank> const& values) {
    auto const& extents = values.extents();
    return {{extents.begin(), extents.end()}, {values.data(), values.size()}};
}

/// The name that diffusers' schedulers and the Python module have for it.
char const* name_of(prediction predicted) {
    switch (predicted) {
    case prediction::epsilon:
        return "epsilon";
    case prediction::velocity:
        return "v_prediction";
    case prediction::clean:
        return "sample";
    case prediction::flow:
        break;
    }
    return "flow";
}

void write_case(std::filesystem::path const& folder, engine_case const& given) {
    auto const& told = given.conditioning;
    auto const& UV = given.UV;
    std::vector<std::size_t> const pixels(UV.coverage.shape().begin(), UV.coverage.shape().end());
    std::vector<float> const coverage(UV.coverage.begin(), UV.coverage.end());
    std::vector<float> object(UV.object.begin(), UV.object.end());
    for (std::size_t i = 0; i < object.size(); ++i) { // numbers of objects are small, of no object anything
        object[i] = coverage[i] > 0 ? object[i] : 0;
    }
    reference::write_safetensors((folder / "case.safetensors").string(),
                                 {{"uv", {{UV.uv.shape().begin(), UV.uv.shape().end()}, {UV.uv.data(), UV.uv.size()}}},
                                  {"object", {pixels, object}},
                                  {"coverage", {pixels, coverage}},
                                  {"hint", source_of(told.hint)},
                                  {"prompt", source_of(told.prompt)},
                                  {"empty_prompt", source_of(told.empty_prompt)}});
    auto const& config = given.config;
    auto const height = told.hint.extent(2);
    auto const width = told.hint.extent(3);
    nlohmann::json const settings{{"height", height},
                                  {"width", width},
                                  {"grid", {height / config.hint_scale(), width / config.hint_scale()}},
                                  {"channels", config.in_channels},
                                  {"steps", given.settings.steps},
                                  {"keyframes", given.settings.keyframes.count},
                                  {"frames_per_call", given.settings.frames_per_call},
                                  {"seed", given.settings.noise.seed},
                                  {"guidance_scale", told.guidance_scale},
                                  {"length_correction", given.settings.injection.length_correction},
                                  {"prediction", name_of(config.prediction_type)},
                                  {"betas", {config.beta_start, config.beta_end, config.num_train_timesteps}}};
    std::ofstream(folder / "case.json") << settings;
}

engine_frames run_client(std::filesystem::path const& folder, engine_case const& given) {
    std::filesystem::create_directories(folder);
    write_case(folder, given);
    auto const command =
        std::string("PYTHONPATH='" GENRENDER_PYTHON_SITE "' '" GENRENDER_PYTHON "' -B '" GENRENDER_CLIENT "' '") +
        folder.string() + "' '" + given.folder.string() + "'";
    if (std::system(command.c_str()) != 0) {
        throw file_error("the client in Python failed: " + command);
    }
    reference::safetensors_file const file((folder / "result.safetensors").string());
    auto const& shape = file.entries().at("z").shape;
    auto const values = file.read<float>("z");
    engine_frames frames;
    frames.z = latents<float>::from_shape({shape.at(0), shape.at(1), shape.at(2), shape.at(3)});
    std::copy(values.begin(), values.end(), frames.z.begin());
    auto const seconds = nlohmann::json::parse(std::ifstream(folder / "result.json"));
    frames.report.denoiser_seconds = seconds.at("denoiser");
    frames.report.library_seconds = seconds.at("library");
    frames.seconds = seconds.at("processor");
    return frames;
}

} // namespace

int main(int argc, char** argv) {
    std::filesystem::path const folder = argc > 1 ? argv[1] : GENRENDER_PYTHON_RUN;
    return compare_frames(GENRENDER_ENGINE, GENRENDER_WAY_IN, 1e-3,
                          [&](engine_case const& given) { return run_client(folder, given); });
}
