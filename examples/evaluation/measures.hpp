// SPDX-License-Identifier: MIT
// [GR sec. 4] All metrics of one run's frames, by their names in the tables.
#pragma once

#include "evaluation_scene.hpp"

#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/evaluation/contrast.hpp>
#include <genrender/evaluation/correspondence_error.hpp>
#include <genrender/evaluation/embeddings.hpp>
#include <genrender/evaluation/flicker.hpp>
#include <genrender/evaluation/frame_consistency.hpp>
#include <genrender/evaluation/prompt_fidelity.hpp>
#include <genrender/evaluation/recognition.hpp>
#include <genrender/evaluation/sharpness.hpp>

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>

namespace genrender::examples {

/// Frames between the two images that are compared, as in the paper's table 2.
inline constexpr std::array<std::size_t, 5> intervals{1, 5, 10, 15, 20};

/// Named figures of one run; a figure is left out where the scene gives none.
using measures = std::map<std::string, double>;

/// Everything that is measured of `images` [frames, 3, height, width] in [0, 1]. `prompts` are the embedder's texts to
/// choose from, the run's own at row `prompt`.
template <image_text_embedder Embedder>
measures measures_of(strided_view<float const, 4> images, evaluation_scene const& scene, Embedder const& embedder,
                     std::span<std::string const> prompts, std::size_t prompt) {
    measures figures;
    auto const set = [&figures](std::string const& name, std::optional<double> figure) {
        if (figure) {
            figures[name] = *figure;
        }
    };
    auto const& objects = scene.pixels.objects();
    for (auto const& error : correspondence_errors(images, scene.pixels, intervals)) {
        set("error_" + std::to_string(error.interval), error.error);
    }
    set("contrast", contrast(images, objects, stands_out));
    set("sharpness", sharpness(images, objects, stands_out));
    for (auto const& error : correspondence_errors(images, scene.pixels, intervals, stands_out)) {
        auto const name = "object_error_" + std::to_string(error.interval);
        set(name, error.error);
        set("object_pairs_" + std::to_string(error.interval), static_cast<double>(error.pairs));
        if (error.error && figures["contrast"] > 0) {
            set("relative_" + name, *error.error / figures["contrast"]);
        }
    }
    auto const vectors = embed_frames(embedder, images);
    auto const texts = embed_texts(embedder, prompts);
    for (auto const interval : intervals) {
        set("consistency_" + std::to_string(interval), frame_consistency(vectors.view(), interval));
    }
    set("fidelity", prompt_fidelity(vectors.view(), texts.view()[prompt]));
    set("recognition", recognition(vectors.view(), texts.view(), prompt));
    set("background_flicker", background_flicker(images, objects));
    if (auto const change = colour_flicker(images)) {
        set("colour_flicker", change->mean);
        set("deviation_flicker", change->deviation);
    }
    return figures;
}

} // namespace genrender::examples
