// SPDX-License-Identifier: MIT
// The network of a run and what makes pictures of its latents: a pipeline of Stable Diffusion, or the reference denoiser.
#pragma once

#include "guidance_source.hpp"
#include "render_options.hpp"
#include "render_output.hpp"

#include <genrender/maps/cell_extents.hpp>
#include <genrender/reference/pipeline_files.hpp>
#include <genrender/reference/reference_network.hpp>
#include <genrender/reference/reference_weights.hpp>
#include <genrender/reference/stable_diffusion.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace genrender::examples {

/// What --pipeline names. A folder whose text encoder is a PromptVocabulary is the reference denoiser's kind: its prompts
/// are words of a list and its latents the Haar bands of a picture. All others are Stable Diffusion's.
class diffusion_model {
public:
    /// Reads what is needed to say all that can be wrong. Throws file_error and value_error that name it.
    explicit diffusion_model(render_options const& options) : prompt_(options.prompt), networks_(read(options)) {
        if (auto const* const weights = std::get_if<reference_weights<float>>(&networks_)) {
            require_value(weights->config.in_channels == 12, "--pipeline", "channels of the latents",
                          weights->config.in_channels, "12, the Haar bands of a colour image");
        }
        if (!prompt_.guidance_scale) {
            auto const is_miniature = options.pipeline == render_options{}.pipeline;
            prompt_.guidance_scale = std::holds_alternative<reference_weights<float>>(networks_) ? 2
                                     : is_miniature                                              ? 3
                                                                                                 : 7.5;
        }
    }

    /// The architecture of its networks.
    unet_config const& config() const {
        return std::visit([](auto const& one) -> unet_config const& { return config_of(one); }, networks_);
    }
    /// Pixels of a picture along a side of a token of the latents.
    std::size_t scale() const {
        auto const* const pipeline = std::get_if<stable_diffusion<float>>(&networks_);
        return pipeline != nullptr ? pipeline->scale() : 2;
    }
    /// Height in pixels of the pictures that it was trained on.
    std::size_t usual_size() const {
        auto const* const pipeline = std::get_if<stable_diffusion<float>>(&networks_);
        return pipeline != nullptr ? pipeline->usual_size() : 64;
    }
    /// The noise levels of its training.
    discrete_noise_schedule schedule() const {
        auto const& of = config();
        return discrete_noise_schedule(
            scaled_linear_alphas_cumprod(of.beta_start, of.beta_end, of.num_train_timesteps));
    }

    /// What a person should know of the prompt: what of it had no room or is unknown. Throws value_error for words that the model does
    /// not know, or a text that is no UTF-8.
    std::vector<std::string> notes() const {
        std::vector<std::string> notes;
        if (auto const* const weights = std::get_if<reference_weights<float>>(&networks_)) {
            if (weights->vocabulary) {
                prompt_rows(prompt_.text, weights->vocabulary->words());
                prompt_rows(prompt_.negative, weights->vocabulary->words());
            }
            return notes;
        }
        auto const& pipeline = std::get<stable_diffusion<float>>(networks_);
        for (auto const& [option, text] :
             {std::pair("--prompt", &prompt_.text), {"--negative-prompt", &prompt_.negative}}) {
            auto const tokens = pipeline.tokens(*text);
            if (tokens.cut > 0) {
                notes.push_back(std::string(option) + ": " + std::to_string(tokens.cut) +
                                " tokens have no room and are " + "cut: " + tokens.cut_text());
            }
            // CLIP's own vocabulary has pieces for every word; a small one is that of the captions of its training.
            if (pipeline.vocabulary_size() < 10'000 && !tokens.split_text().empty()) {
                notes.push_back(std::string(option) +
                                ": the model was trained on no such words: " + tokens.split_text());
            }
        }
        return notes;
    }

    /// The network that renders the depth of the guidance in pictures of these extents.
    reference_network<float> network(rendered_guidance const& guidance, grid_extents image, any_loop const& loop) {
        auto const nearness = cell_means(sequence_inverse_depth(guidance.depth), image);
        if (auto* const weights = std::get_if<reference_weights<float>>(&networks_)) {
            auto conditioning = weights->conditioning(to_view(nearness), word_or(prompt_.text, *weights),
                                                      static_cast<float>(*prompt_.guidance_scale));
            if (!prompt_.negative.empty()) {
                conditioning.empty_prompt = (*weights->vocabulary)(prompt_.negative);
            }
            conditioning.conditioning_scale = static_cast<float>(prompt_.conditioning_scale);
            conditioning.guidance_rescale = static_cast<float>(prompt_.guidance_rescale);
            return {*weights, std::move(conditioning), loop};
        }
        auto const& pipeline = std::get<stable_diffusion<float>>(networks_);
        auto conditioning = pipeline.conditioning(to_view(nearness),
                                                  {.text = prompt_.text,
                                                   .negative = prompt_.negative,
                                                   .guidance_scale = *prompt_.guidance_scale,
                                                   .guidance_rescale = prompt_.guidance_rescale,
                                                   .conditioning_scale = prompt_.conditioning_scale,
                                                   .skipped_layers = prompt_.clip_skip},
                                                  loop);
        return pipeline.network(std::move(conditioning), loop);
    }

    /// Pictures [frames, 3, height, width] in [0, 1] of latents, as a file will hold them.
    tensor<float, 4> pictures(latents<float> const& z, any_loop const& loop) const {
        auto const* const pipeline = std::get_if<stable_diffusion<float>>(&networks_);
        if (pipeline == nullptr) {
            return decoded(z);
        }
        auto const made = pipeline->pictures(to_view(z), loop);
        auto const [frames, channels, height, width] = made.extents();
        auto result = tensor<float, 4>::from_shape({frames, channels, height, width});
        copy(to_view(result), made.view());
        return result;
    }

private:
    using networks = std::variant<reference_weights<float>, stable_diffusion<float>>;

    static unet_config const& config_of(reference_weights<float> const& weights) { return weights.config; }
    static unet_config const& config_of(stable_diffusion<float> const& pipeline) { return pipeline.config(); }

    static networks read(render_options const& options) {
        if (options.pipeline == "random") {
            return reference_weights<float>::seeded(options.seed);
        }
        pipeline_files files(options.pipeline, options.controlnet,
                             {.variant = options.variant,
                              .prediction_type = options.prediction_type,
                              // Without instructions for them, weights of 16 bits take twice the time.
                              .keeps_file_width = chosen_vector_target() != vector_target::baseline});
        for (auto const& [path, scale] : options.loras) {
            files.add_lora(path, scale);
        }
        if (files.folder() != nullptr && options.tokenizer.empty()) {
            auto config = files.config();
            if (auto vocabulary = files.folder()->vocabulary<float>(config.cross_attention_dim)) {
                return reference_weights<float>{std::move(config), files.tensors<float>(reference::model_part::unet),
                                                files.tensors<float>(reference::model_part::controlnet),
                                                std::move(vocabulary)};
            }
        }
        return networks(std::in_place_type<stable_diffusion<float>>, std::move(files), options.tokenizer);
    }

    /// A text, or for questions that any word will do for, the first that there is.
    static std::string word_or(std::string const& text, reference_weights<float> const& weights) {
        return text.empty() && weights.vocabulary ? weights.vocabulary->words().front() : text;
    }

    prompt_options prompt_;
    networks networks_;
};

} // namespace genrender::examples
