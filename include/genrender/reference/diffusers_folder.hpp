// SPDX-License-Identifier: MIT
// A folder of networks in diffusers' layout, as save_pretrained writes it and as models are published.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/config_file.hpp>
#include <genrender/reference/diffusers_config.hpp>
#include <genrender/reference/model_part.hpp>
#include <genrender/reference/tensor_place.hpp>
#include <genrender/reference/unet_config.hpp>
#include <genrender/reference/weight_files.hpp>
#include <genrender/reference/weights.hpp>

#include <array>
#include <concepts>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace genrender::reference {

namespace internal {

/// A text encoder's tensors, positions left out, which are no parameters. Files of transformers 5 leave out `text_model.`,
/// with which all others begin.
inline tensor_places with_text_names(tensor_places places) {
    std::erase_if(places, [](auto const& item) { return item.first.ends_with("embeddings.position_ids"); });
    if (!places.contains("embeddings.token_embedding.weight")) {
        return places;
    }
    tensor_places result;
    for (auto const& [name, place] : places) {
        add_places(result, {{(name.starts_with("text_model.") ? "" : "text_model.") + name, place}});
    }
    return result;
}

/// The attention of a VAE in the names that diffusers has today: folders that are older than those call them query,
/// key, value and proj_attn, some with 1x1 kernels for matrices.
inline tensor_places with_attention_names(tensor_places const& places) {
    static constexpr std::array<std::array<std::string_view, 2>, 4> rules{
        {{".query.", ".to_q."}, {".key.", ".to_k."}, {".value.", ".to_v."}, {".proj_attn.", ".to_out.0."}}};
    tensor_places result;
    for (auto const& [name, place] : places) {
        auto renamed = name;
        auto moved = place;
        if (name.find("mid_block.attentions.") != std::string::npos) {
            for (auto const& [from, to] : rules) {
                if (auto const at = renamed.find(from); at != std::string::npos) {
                    renamed.replace(at, from.size(), to);
                }
            }
            auto& shape = moved.shape;
            if (shape.size() == 4 && shape[2] == 1 && shape[3] == 1) {
                shape.resize(2);
            }
        }
        add_places(result, {{renamed, moved}});
    }
    return result;
}

/// Throws file_error if a folder's model_index.json, where it has one, says that it is of another architecture.
inline void refuse_foreign_pipeline(std::filesystem::path const& folder) {
    static constexpr std::array<std::array<char const*, 2>, 7> foreign{
        {{"StableDiffusionXL", "Stable Diffusion XL"},
         {"StableDiffusion3", "Stable Diffusion 3"},
         {"Flux", "Flux"},
         {"Inpaint", "a model for inpainting"},
         {"LatentConsistency", "an LCM"},
         {"InstructPix2Pix", "a model for editing"},
         {"Depth2Img", "told depth beside the latents"}}};
    if (!std::filesystem::exists(folder / "model_index.json")) {
        return;
    }
    config_file const index(folder / "model_index.json");
    auto const& name = index["_class_name"];
    for (auto const& [part, what] : foreign) {
        index.require(!name.is_string() || name.get<std::string>().find(part) == std::string::npos, "_class_name",
                      std::string("a pipeline of Stable Diffusion 1.x or 2.x (this is ") + what + ")");
    }
}

} // namespace internal

/// The parts of a folder:
///
///     unet/                      config.json, diffusion_pytorch_model.safetensors
///     controlnet/                config.json, diffusion_pytorch_model.safetensors
///     vae/                       config.json, diffusion_pytorch_model.safetensors
///     scheduler/                 scheduler_config.json
///     text_encoder/              config.json, model.safetensors
///
/// where the ControlNet may be a folder of its own, and weights may lie in shards or as variants (see find_weights).
class diffusers_folder {
public:
    /// Reads no file yet. `controlnet` is by default the folder of that name inside. With a `variant`, say `fp16`, all
    /// weights are of that one.
    explicit diffusers_folder(std::filesystem::path folder, std::filesystem::path controlnet = {},
                              std::string variant = {})
        : folder_(std::move(folder)), controlnet_(controlnet.empty() ? folder_ / "controlnet" : std::move(controlnet)),
          variant_(std::move(variant)) {}

    /// The folder itself.
    std::filesystem::path const& path() const { return folder_; }
    /// Whether a network is there.
    bool has(model_part part) const { return std::filesystem::exists(place_of(part) / "config.json"); }
    /// A network's config.json. Throws file_error if it cannot be read.
    config_file options(model_part part) const { return config_file(place_of(part) / "config.json"); }
    /// The scheduler_config.json. Throws file_error if it cannot be read.
    config_file scheduler_options() const { return config_file(folder_ / "scheduler" / "scheduler_config.json"); }
    /// Throws file_error by name if model_index.json, where there is one, says that the folder is of an architecture
    /// other than Stable Diffusion 1.x and 2.x.
    void refuse_foreign() const { internal::refuse_foreign_pipeline(folder_); }
    /// The architecture. Throws as read_diffusers_config and refuse_foreign do.
    unet_config config() const {
        refuse_foreign();
        auto unet = options(model_part::unet);
        auto controlnet = options(model_part::controlnet);
        return read_diffusers_config(std::move(unet), std::move(controlnet), scheduler_options());
    }

    /// A network's tensors. Throws file_error as find_weights does.
    tensor_places places(model_part part) const {
        auto const stem = part == model_part::text_encoder ? "model" : "diffusion_pytorch_model";
        auto found = find_weights(place_of(part), stem, variant_);
        return part == model_part::text_encoder ? internal::with_text_names(std::move(found))
               : part == model_part::vae        ? internal::with_attention_names(found)
                                                : found;
    }
    /// The same, to build the network of. Throws file_error as find_weights does.
    template <std::floating_point Real>
    weights<Real> tensors(model_part part) const {
        return weights<Real>::from_places(places(part), place_of(part).string());
    }

    /// The UNet's tensors. Throws file_error as find_weights does.
    template <std::floating_point Real>
    weights<Real> unet() const {
        return tensors<Real>(model_part::unet);
    }
    /// The ControlNet's tensors. Throws file_error as find_weights does.
    template <std::floating_point Real>
    weights<Real> controlnet() const {
        return tensors<Real>(model_part::controlnet);
    }

private:
    std::filesystem::path place_of(model_part part) const {
        return part == model_part::controlnet ? controlnet_
               : part == model_part::unet     ? folder_ / "unet"
               : part == model_part::vae      ? folder_ / "vae"
                                              : folder_ / "text_encoder";
    }

    std::filesystem::path folder_;
    std::filesystem::path controlnet_;
    std::string variant_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
