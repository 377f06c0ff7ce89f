// SPDX-License-Identifier: MIT
// [GR sec. 4] All metrics of one run's frames, by their names in the tables.
#pragma once

#include "caption.hpp"
#include "evaluation_scene.hpp"
#include "results.hpp"

#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/evaluation/contrast.hpp>
#include <genrender/evaluation/correspondence_error.hpp>
#include <genrender/evaluation/embeddings.hpp>
#include <genrender/evaluation/flicker.hpp>
#include <genrender/evaluation/frame_consistency.hpp>
#include <genrender/evaluation/perceptual_error.hpp>
#include <genrender/evaluation/prompt_fidelity.hpp>
#include <genrender/evaluation/recognition.hpp>
#include <genrender/evaluation/sharpness.hpp>
#include <genrender/evaluation/sticking.hpp>
#include <genrender/evaluation/subject_consistency.hpp>
#include <genrender/evaluation/temporal_flicker.hpp>
#include <genrender/reference/reference_clip.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace genrender::examples {

/// Frames between the two images that are compared, as in the paper's table 2.
inline constexpr std::array<std::size_t, 5> intervals{1, 5, 10, 15, 20};
/// The same of a long sequence.
inline constexpr std::array<std::size_t, 8> long_intervals{1, 5, 10, 20, 50, 100, 150, 200};

/// Pixels around objects that are no open background: two cells of the miniature's latents, which its decoder mixes.
inline constexpr std::size_t open_background_margin = 8;

/// Raised when a measure changes its meaning, so that kept figures are not mixed.
inline constexpr int measures_version = 2;

/// Features of every frame of `images` [frames, 3, height, width]: [frames, channels, rows, columns].
inline stack<float, 4> frame_features(reference_clip<float> const& embedder, strided_view<float const, 4> images) {
    stack<float, 4> all;
    for (std::size_t i = 0; i < images.extent(0); ++i) {
        auto const features = embedder.image_features(images[i]);
        if (i == 0) {
            auto const [channels, rows, columns] = features.extents();
            all = stack<float, 4>::uninitialized({images.extent(0), channels, rows, columns});
        }
        copy(all.view()[i], features.view());
    }
    return all;
}

/// Everything that is measured of `images` [frames, 3, height, width] in [0, 1], rendered to a caption. Errors along
/// surfaces are those of what stands out, the ground left out.
inline measures measures_of(strided_view<float const, 4> images, evaluation_scene const& scene,
                            compared_caption const& caption, reference_clip<float> const& embedder,
                            std::span<std::size_t const> apart = intervals) {
    measures figures;
    auto const set = [&figures](std::string const& name, std::optional<double> figure) {
        if (figure) {
            figures[name] = *figure;
        }
    };
    auto const& objects = scene.pixels.objects();
    set("contrast", contrast(images, objects, stands_out));
    set("sharpness", sharpness(images, objects, stands_out));
    for (auto const& error : correspondence_errors(images, scene.pixels, apart, stands_out)) {
        auto const interval = std::to_string(error.interval);
        set("error_" + interval, error.error);
        set("pairs_" + interval, static_cast<double>(error.pairs));
        if (error.error && figures["contrast"] > 0) {
            set("relative_error_" + interval, *error.error / figures["contrast"]);
        }
    }
    for (auto const& found : sticking(images, scene.pixels, apart, stands_out)) {
        set("sticking_" + std::to_string(found.interval), found.ratio);
        set("moving_pairs_" + std::to_string(found.interval), static_cast<double>(found.pairs));
    }
    auto const features = frame_features(embedder, images);
    for (auto const& error : perceptual_errors(features.view(), scene.pixels, apart, stands_out)) {
        set("perceptual_error_" + std::to_string(error.interval), error.error);
    }
    auto const vectors = embed_frames(embedder, images);
    for (auto const interval : apart) {
        set("consistency_" + std::to_string(interval), frame_consistency(vectors.view(), interval));
    }
    set("subject_consistency", subject_consistency(vectors.view()));
    auto const prompt = embed_texts(embedder, std::array{text_of(caption, scene.subject)});
    set("fidelity", prompt_fidelity(vectors.view(), prompt.view()[0]));
    auto const ask = [&](char const* name, recognition_question const& question) {
        auto const texts = embed_texts(embedder, question.texts);
        set(name, recognition(vectors.view(), texts.view(), question.truth));
    };
    ask("pattern_recognised", pattern_question(caption));
    ask("colours_recognised", colours_question(caption));
    set("background_flicker", background_flicker(images, objects));
    set("open_background_flicker", background_flicker(images, objects, open_background_margin));
    if (auto const change = colour_flicker(images)) {
        set("colour_flicker", change->mean);
        set("deviation_flicker", change->deviation);
    }
    set("temporal_flicker", temporal_flicker(images));
    return figures;
}

} // namespace genrender::examples
