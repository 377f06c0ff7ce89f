// SPDX-License-Identifier: MIT
// A single-file checkpoint of Stable Diffusion 1.x or 2.x, or of a ControlNet, in CompVis' names.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/compvis_architecture.hpp>
#include <genrender/reference/compvis_names.hpp>
#include <genrender/reference/config_file.hpp>
#include <genrender/reference/model_part.hpp>
#include <genrender/reference/pickles.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/tensor_place.hpp>
#include <genrender/reference/unet_config.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::reference {

namespace internal {

/// A tensor by which a checkpoint of another architecture is known.
struct foreign_sign {
    std::string_view part; ///< of the tensor's name
    char const* what;      ///< the checkpoint is
};

inline constexpr foreign_sign foreign_signs[] = {
    {"joint_blocks.", "of Stable Diffusion 3"},
    {"double_blocks.", "of Flux"},
    {"conditioner.embedders.", "of Stable Diffusion XL"},
    {"model.diffusion_model.label_emb.", "told a class or a size beside the prompt (Stable Diffusion XL, an upscaler)"},
    {"time_embed.cond_proj.", "of a latent consistency model (LCM)"},
    {"time_embedding.cond_proj.", "of a latent consistency model (LCM)"},
    {"image_embeddings.", "of unCLIP"},
    {"embedder.model.visual.", "of unCLIP"},
    {"lora_controlnet", "a control-LoRA, which holds differences alone"},
    {"lora_", "a LoRA, which is merged into another model"},
    {".lora.down.weight", "a LoRA, which is merged into another model"},
    {".lora_A.weight", "a LoRA, which is merged into another model"},
    {"down_blocks.0.resnets.0.", "one network of a diffusers folder, which is found by its folder"}};

} // namespace internal

/// The networks of a checkpoint, as those of a diffusers folder are: their options, which it infers, and their tensors.
/// Averages of the weights, losses and noise schedules are left where they are.
class single_file {
public:
    /// Reads the header. `prediction_type` is what the UNet was trained to predict, which no tensor says: by default
    /// epsilon in 1.x; of 2.x, `512-base` predicts epsilon and `768-v` velocity, so it must be told. Throws file_error if it is a pickle (see pickles.hpp)
    /// or no safetensors file, of another architecture (SDXL, SD 3, Flux, inpainting, LCM, ... by name), or has tensors
    /// whose names are unknown.
    explicit single_file(std::filesystem::path const& path, std::optional<prediction> prediction_type = {})
        : path_(path.string()), prediction_type_(prediction_type) {
        refuse_pickle(path);
        auto const file = std::make_shared<safetensors_file const>(path_);
        refuse_foreign(*file);
        auto const layout = layout_of(*file);
        counted_names unknown;
        for (auto const& [stored, entry] : file->entries()) {
            if (is_training_leftover(stored)) {
                continue;
            }
            auto const named = diffusers_names(with_prefix(*file, stored), layout);
            if (!named) {
                unknown.add(stored);
                continue;
            }
            for (auto const& tensor : named->tensors) {
                add(*named, tensor, {file, stored, entry.shape, 0});
            }
            is_open_clip_ = is_open_clip_ || stored.starts_with("cond_stage_model.model.");
        }
        if (unknown.count() > 0) {
            throw file_error(path_ + ": " + std::to_string(unknown.count()) + " tensors are unknown: " +
                             unknown.text() + ", expected those of Stable Diffusion 1.x or 2.x or of a ControlNet");
        }
        drop_last_layer();
        require_family();
    }

    /// Path of the file that it was read from.
    std::string const& path() const { return path_; }
    /// Whether it holds tensors of a network.
    bool has(model_part part) const { return parts_.contains(part); }
    /// The tensors of a network in diffusers' names. Throws file_error if it holds none.
    tensor_places const& places(model_part part) const {
        auto const found = parts_.find(part);
        if (found == parts_.end()) {
            throw file_error(path_ + ": file holds no " + name_of(part) + ", expected one");
        }
        return found->second;
    }
    /// The same, to build the network of. Throws file_error if it holds none.
    template <std::floating_point Real>
    weights<Real> tensors(model_part part) const {
        return weights<Real>::from_places(places(part), path_);
    }

    /// What diffusers would have in a network's config.json. Throws file_error if it holds none, or tensors are missing
    /// without which nothing can be inferred.
    config_file options(model_part part) const {
        auto const& of_part = places(part);
        switch (part) {
        case model_part::vae:
            return {path_, infer_vae_options(of_part, path_)};
        case model_part::text_encoder:
            return {path_, infer_text_options(of_part, path_, is_open_clip_)};
        case model_part::controlnet:
            return {path_, controlnet_json(infer_unet_config(of_part, path_))};
        default:
            return {path_, unet_json(infer_unet_config(of_part, path_))};
        }
    }
    /// What diffusers would have in scheduler_config.json. Throws file_error if it holds no UNet, or one of 2.x and
    /// nobody told what it predicts; value_error as scheduler_json does.
    config_file scheduler_options() const {
        auto config = infer_unet_config(places(model_part::unet), path_);
        if (!prediction_type_ && config.cross_attention_dim != 768) {
            throw file_error(path_ +
                             ": what this UNet of Stable Diffusion 2.x predicts is not in the file, expected to "
                             "be told: epsilon (512-base) or velocity (768-v)");
        }
        config.prediction_type = prediction_type_.value_or(prediction::epsilon);
        return {path_, scheduler_json(config)};
    }

private:
    void refuse_foreign(safetensors_file const& file) const {
        for (auto const& [part, what] : internal::foreign_signs) {
            for (auto const& [name, entry] : file.entries()) {
                if (name.find(part) != std::string::npos) {
                    throw file_error(path_ + ": checkpoint is " + what + " (it holds " + name +
                                     "), expected Stable Diffusion 1.x or 2.x or a ControlNet of theirs");
                }
            }
        }
        auto const first = file.entries().find("model.diffusion_model.input_blocks.0.0.weight");
        if (first != file.entries().end() && first->second.shape.size() == 4 && first->second.shape[1] != 4) {
            auto const channels = first->second.shape[1];
            std::string const what = channels == 9   ? "for inpainting"
                                     : channels == 8 ? "for editing (InstructPix2Pix)"
                                     : channels == 5 ? "told depth beside the latents (depth2img)"
                                                     : "of another kind";
            throw file_error(path_ + ": checkpoint is " + what + " (its UNet takes " + std::to_string(channels) +
                             " channels), expected one that takes the 4 of latents alone");
        }
    }

    /// ControlNets are published with and without the prefix.
    static std::string with_prefix(safetensors_file const& file, std::string const& name) {
        return file.entries().contains("zero_convs.0.0.weight") ? "control_model." + name : name;
    }

    static compvis_layout layout_of(safetensors_file const& file) {
        compvis_layout layout;
        // The first layer that halves the grid ends the first level.
        for (std::size_t i = 1; i < 16; ++i) {
            auto const name = "input_blocks." + std::to_string(i) + ".0.op.weight";
            if (std::ranges::any_of(file.entries(), [&](auto const& item) { return item.first.ends_with(name); })) {
                layout.unet_layers = i - 1;
                break;
            }
        }
        auto const has_level = [&](std::size_t level) {
            return file.entries().contains("first_stage_model.encoder.down." + std::to_string(level) +
                                           ".block.0.conv1.weight");
        };
        for (layout.vae_levels = 0; has_level(layout.vae_levels);) {
            ++layout.vae_levels;
        }
        layout.unet_layers = std::max<std::size_t>(1, layout.unet_layers);
        return layout;
    }

    void add(renamed_tensors const& named, renamed_tensor const& tensor, tensor_place place) {
        auto& shape = place.shape;
        if (tensor.is_matrix && shape.size() == 4 && shape[2] == 1 && shape[3] == 1) {
            shape.resize(2);
        }
        if (tensor.parts > 1) {
            if (shape.empty() || shape[0] % tensor.parts != 0) {
                throw file_error(path_ + ": tensor " + place.stored + " is " + extents_text(shape) +
                                 ", expected rows of queries, keys and values");
            }
            shape[0] /= tensor.parts;
            place.first = tensor.part * place.count();
        }
        auto const stored = place.stored;
        auto const [other, is_new] = parts_[named.part].emplace(tensor.name, std::move(place));
        if (!is_new) {
            throw file_error(path_ + ": tensors " + other->second.stored + " and " + stored + " are both " +
                             tensor.name + ", expected one");
        }
    }

    /// SD 2.x attends to what goes into OpenCLIP's last layer.
    void drop_last_layer() {
        auto const found = parts_.find(model_part::text_encoder);
        if (!is_open_clip_ || found == parts_.end()) {
            return;
        }
        auto const prefix = std::string("text_model.encoder.layers.");
        std::size_t last = 0;
        auto const number_of = [&](std::string const& name) {
            auto rest = std::string_view(name);
            return internal::take_prefix(rest, prefix) ? internal::take_number(rest) : std::nullopt;
        };
        for (auto const& [name, place] : found->second) {
            last = std::max(last, number_of(name).value_or(0));
        }
        std::erase_if(found->second, [&](auto const& item) { return last > 0 && number_of(item.first) == last; });
    }

    void require_family() const {
        if (parts_.empty()) {
            throw file_error(path_ + ": file holds no network, expected a checkpoint of Stable Diffusion 1.x or 2.x or "
                                     "of a ControlNet");
        }
        for (auto const part : {model_part::unet, model_part::controlnet}) {
            if (has(part)) {
                auto const width = infer_unet_config(places(part), path_).cross_attention_dim;
                if (width != 768 && width != 1024) {
                    throw file_error(path_ + ": checkpoint attends to tokens of " + std::to_string(width) +
                                     " channels, expected the 768 of Stable Diffusion 1.x or the 1024 of 2.x");
                }
            }
        }
    }

    std::string path_;
    std::optional<prediction> prediction_type_;
    bool is_open_clip_ = false;
    std::map<model_part, tensor_places> parts_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
