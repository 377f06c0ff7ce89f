// SPDX-License-Identifier: MIT
// The network of a run and what makes pictures of its latents: a pipeline of Stable Diffusion.
#pragma once

#include "guidance_source.hpp"
#include "model_key.hpp"
#include "render_options.hpp"

#include <genrender/core/fingerprint.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/maps/cell_extents.hpp>
#include <genrender/reference/pipeline_files.hpp>
#include <genrender/reference/reference_network.hpp>
#include <genrender/reference/stable_diffusion.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::examples {

/// What --pipeline names, with what else is told of the model.
class diffusion_model {
public:
    /// Reads what is needed to say all that can be wrong. Throws file_error and value_error that name it.
    explicit diffusion_model(render_options const& options)
        : prompt_(options.prompt), pipeline_(files_of(options), options.tokenizer), told_(options) {
        if (!prompt_.guidance_scale) {
            auto const is_miniature = options.pipeline == render_options{}.pipeline;
            prompt_.guidance_scale = is_miniature ? 3 : 7.5;
        }
    }

    /// The architecture of its networks.
    reference::unet_config const& config() const { return pipeline_.config(); }
    /// Pixels of a picture along a side of a token of the latents.
    std::size_t scale() const { return pipeline_.scale(); }
    /// Height in pixels of the pictures that it was trained on.
    std::size_t usual_size() const { return pipeline_.usual_size(); }
    /// The noise levels of its training.
    discrete_noise_schedule schedule() const { return pipeline_.schedule(); }

    /// What a person should know of the prompt: what of it had no room or is unknown. Throws value_error for a text that
    /// is no UTF-8.
    std::vector<std::string> notes() const {
        std::vector<std::string> notes;
        for (auto const& [option, text] :
             {std::pair("--prompt", &prompt_.text), {"--negative-prompt", &prompt_.negative}}) {
            auto const tokens = pipeline_.tokens(*text);
            if (tokens.cut > 0) {
                notes.push_back(std::string(option) + ": " + std::to_string(tokens.cut) +
                                " tokens have no room and are " + "cut: " + tokens.cut_text());
            }
            // CLIP's own vocabulary has pieces for every word; a small one is that of the captions of its training.
            if (pipeline_.vocabulary_size() < 10'000 && !tokens.split_text().empty()) {
                notes.push_back(std::string(option) +
                                ": the model was trained on no such words: " + tokens.split_text());
            }
        }
        return notes;
    }

    /// A fingerprint of all weights and of what is told of pictures, as text. Reads the files once more.
    std::string key() const {
        fingerprint all;
        add_model(all, told_.pipeline, told_.variant);
        add_model(all, told_.controlnet, told_.variant);
        add_model(all, told_.tokenizer);
        for (auto const& [path, scale] : told_.loras) {
            add_model(all, path);
            all.add(scale);
        }
        all.add(told_.prediction_type);
        all.add(std::string_view(prompt_.text));
        all.add(std::string_view(prompt_.negative));
        all.add(prompt_.guidance_scale);
        all.add(prompt_.guidance_rescale);
        all.add(prompt_.conditioning_scale);
        all.add(prompt_.clip_skip);
        return std::to_string(all.value());
    }

    /// The network that renders the depth of the guidance in pictures of these extents.
    reference_network<float> network(rendered_guidance const& guidance, grid_extents image,
                                     any_loop const& loop) const {
        auto const nearness = cell_means(sequence_inverse_depth(guidance.depth), image);
        auto conditioning = pipeline_.conditioning(to_view(nearness),
                                                   {.text = prompt_.text,
                                                    .negative = prompt_.negative,
                                                    .guidance_scale = *prompt_.guidance_scale,
                                                    .guidance_rescale = prompt_.guidance_rescale,
                                                    .conditioning_scale = prompt_.conditioning_scale,
                                                    .skipped_layers = prompt_.clip_skip},
                                                   loop);
        return pipeline_.network(std::move(conditioning), loop);
    }

    /// Pictures [frames, 3, height, width] in [0, 1] of latents, as a file will hold them.
    tensor<float, 4> pictures(latents<float> const& z, any_loop const& loop) const {
        auto const made = pipeline_.pictures(to_view(z), loop);
        auto const [frames, channels, height, width] = made.extents();
        auto result = tensor<float, 4>::from_shape({frames, channels, height, width});
        copy(to_view(result), made.view());
        return result;
    }

private:
    static reference::pipeline_files files_of(render_options const& options) {
        reference::pipeline_files files(options.pipeline, options.controlnet,
                                        {.variant = options.variant,
                                         .prediction_type = options.prediction_type,
                                         // Without instructions for them, weights of 16 bits take twice the time.
                                         .keeps_file_width = chosen_vector_target() != vector_target::baseline});
        for (auto const& [path, scale] : options.loras) {
            files.add_lora(path, scale);
        }
        return files;
    }

    prompt_options prompt_;
    reference::stable_diffusion<float> pipeline_;
    render_options told_;
};

} // namespace genrender::examples
