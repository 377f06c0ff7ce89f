// SPDX-License-Identifier: MIT
// A whole pipeline of Stable Diffusion 1.x or 2.x with a ControlNet that looks at depth: from words and inverse depth to the
// network of a run, and from its latents to pictures.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/core/stack.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/reference/autoencoder_config_file.hpp>
#include <genrender/reference/autoencoder_kl.hpp>
#include <genrender/reference/clip_text_config_file.hpp>
#include <genrender/reference/clip_text_encoder.hpp>
#include <genrender/reference/clip_tokenizer.hpp>
#include <genrender/reference/clip_tokenizer_folder.hpp>
#include <genrender/reference/network_conditioning.hpp>
#include <genrender/reference/pipeline_files.hpp>
#include <genrender/reference/reference_network.hpp>
#include <genrender/sampling/noise_schedule.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::reference {

/// What the pictures of a run shall show, and how strictly.
struct diffusion_prompt {
    std::string text{};             ///< what they shall show, in any words
    std::string negative{};         ///< what they shall not; what unguided pictures show
    double guidance_scale = 7.5;    ///< of classifier-free guidance; 1 runs the text alone
    double guidance_rescale = 0;    ///< share of rescale_guidance, in [0, 1]
    double conditioning_scale = 1;  ///< factor of what the ControlNet adds
    std::size_t skipped_layers = 0; ///< last layers of the text encoder that do not run (diffusers' clip_skip)
};

/// The networks of a pipeline. Tokenizer, configs and the VAE's decoder are read at once; text encoder, UNet and
/// ControlNet, which are larger, when they are asked for, so that the text encoder's memory is free again before the
/// UNet's is taken.
template <std::floating_point Real>
class stable_diffusion {
public:
    /// Of a diffusers folder or a single file. A single file has no tokenizer: `tokenizer` is a folder with one, by default
    /// that in the pipeline's folder. Throws file_error naming the file, the option or the tensors at fault, those of the
    /// networks that are read later too; value_error if there is no tokenizer, or parts do not fit each other.
    explicit stable_diffusion(pipeline_files files, std::filesystem::path const& tokenizer = {})
        : files_(std::move(files)), config_(files_.config()), tokenizer_(tokenizer_of(files_, tokenizer)),
          text_config_(read_clip_text_config(files_.options(model_part::text_encoder))), decoder_(decoder_of(files_)) {
        auto const function = "stable_diffusion";
        require_value(text_config_.hidden_size == config_.cross_attention_dim, function,
                      "hidden_size of the text encoder", text_config_.hidden_size,
                      ("the UNet's cross_attention_dim " + std::to_string(config_.cross_attention_dim)).c_str());
        require_value(tokenizer_.size() <= text_config_.vocab_size, function, "tokens of the tokenizer",
                      tokenizer_.size(),
                      ("at most the text encoder's " + std::to_string(text_config_.vocab_size)).c_str());
        require_value(tokenizer_.context_length() <= text_config_.max_position_embeddings, function,
                      "context length of the tokenizer", tokenizer_.context_length(),
                      ("at most the text encoder's " + std::to_string(text_config_.max_position_embeddings)).c_str());
        require_value(decoder_.config().latent_channels == config_.in_channels, function, "latent_channels of the VAE",
                      decoder_.config().latent_channels,
                      ("the UNet's in_channels " + std::to_string(config_.in_channels)).c_str());
        require_value(decoder_.config().scale() == config_.hint_scale(), function, "pixels a token of the VAE",
                      decoder_.config().scale(), ("the ControlNet's " + std::to_string(config_.hint_scale())).c_str());
        unet<Real>::require_all_tensors(config_, files_.template tensors<Real>(model_part::unet));
        controlnet<Real>::require_all_tensors(config_, files_.template tensors<Real>(model_part::controlnet));
        require_tensors(files_.template tensors<Real>(model_part::text_encoder),
                        [&](weights<Real>& listing) { clip_text_encoder<Real> const network(text_config_, listing); });
    }

    /// The architecture of UNet and ControlNet.
    unet_config const& config() const { return config_; }
    /// Pixels along a side of a token of the latents.
    std::size_t scale() const { return config_.hint_scale(); }
    /// Pixels along a side of the pictures of the training, by the UNet's sample_size.
    std::size_t usual_size() const { return scale() * files_.options(model_part::unet).count("sample_size", 64); }
    /// The noise levels of the training, whose ends a run's schedule begins and ends with.
    discrete_noise_schedule schedule() const {
        return discrete_noise_schedule(
            scaled_linear_alphas_cumprod(config_.beta_start, config_.beta_end, config_.num_train_timesteps));
    }
    /// How many tokens its tokenizer has.
    std::size_t vocabulary_size() const { return text_config_.vocab_size; }
    /// A text as the text encoder takes it, and what of it had no room. Throws value_error for what is no UTF-8.
    clip_prompt tokens(std::string_view text) const { return tokenizer_(text); }

    /// What the network of a run is told: inverse depth [frames, height, width] of the pictures in [0, 1], nearest = 1,
    /// and the prompt. Reads the text encoder and frees it. Throws value_error for a text that is no UTF-8 or more skipped
    /// layers than there are, file_error if the file has changed.
    network_conditioning<Real> conditioning(strided_view<float const, 3> inverse_depth, diffusion_prompt const& prompt,
                                            any_loop const& loop = {}) const {
        auto source = files_.template tensors<Real>(model_part::text_encoder);
        clip_text_encoder<Real> const encode(text_config_, source);
        auto const rows_of = [&](std::string_view text) {
            auto const ids = tokenizer_(text).ids;
            std::vector<std::uint32_t> const numbers(ids.begin(), ids.end());
            return encode(numbers, loop, prompt.skipped_layers);
        };
        return {.hint = depth_hint<Real>(inverse_depth, config_.conditioning_channels),
                .prompt = rows_of(prompt.text),
                .empty_prompt = rows_of(prompt.negative),
                .guidance_scale = static_cast<Real>(prompt.guidance_scale),
                .conditioning_scale = static_cast<Real>(prompt.conditioning_scale),
                .guidance_rescale = static_cast<Real>(prompt.guidance_rescale)};
    }

    /// The network of a run. Reads UNet and ControlNet. Throws as reference_network's constructor does.
    reference_network<Real> network(network_conditioning<Real> conditioning, any_loop loop = {}) const {
        auto unet_weights = files_.template tensors<Real>(model_part::unet);
        auto control_weights = files_.template tensors<Real>(model_part::controlnet);
        return {config_, unet_weights, control_weights, std::move(conditioning), std::move(loop)};
    }

    /// The pictures of latents z [frames, channels, height, width]: [frames, 3, scale() height, scale() width] in [0, 1], red,
    /// green, blue, as diffusers clamps them. One after the other, so that memory is that of one. Throws shape_error if z has
    /// other channels.
    stack<float, 4> pictures(strided_view<Real const, 4> z, any_loop const& loop = {}) const {
        stack<float, 4> result({z.extent(0), 3, scale() * z.extent(2), scale() * z.extent(3)});
        auto* to = result.data();
        for (std::size_t i = 0; i < z.extent(0); ++i) {
            auto const picture = decoder_.decode(z[i], {.loop = loop});
            to = std::transform(picture.data(), picture.data() + picture.size(), to, [](Real value) {
                return static_cast<float>(std::clamp(value / 2 + Real(0.5), Real(0), Real(1)));
            });
        }
        return result;
    }

private:
    static clip_tokenizer tokenizer_of(pipeline_files const& files, std::filesystem::path const& folder) {
        require_value(!folder.empty() || files.folder() != nullptr, "stable_diffusion", "tokenizer", "not given",
                      "a folder with vocab.json and merges.txt, which a single file does not hold");
        return load_clip_tokenizer(folder.empty() ? files.folder()->path() / "tokenizer" : folder);
    }

    static autoencoder_kl<Real> decoder_of(pipeline_files const& files) {
        auto source = files.template tensors<Real>(model_part::vae);
        auto const config = read_autoencoder_config(files.options(model_part::vae));
        require_tensors(source, [&](weights<Real>& listing) {
            autoencoder_kl<Real> const network(config, listing, autoencoder_parts::decoder);
        });
        return {config, source, autoencoder_parts::decoder};
    }

    pipeline_files files_;
    unet_config config_;
    clip_tokenizer tokenizer_;
    clip_text_config text_config_;
    autoencoder_kl<Real> decoder_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
