// SPDX-License-Identifier: MIT
// The files of a pipeline as people have them: a diffusers folder or a single file, and so the ControlNet.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/config_file.hpp>
#include <genrender/reference/diffusers_config.hpp>
#include <genrender/reference/diffusers_folder.hpp>
#include <genrender/reference/lora_file.hpp>
#include <genrender/reference/lora_merge.hpp>
#include <genrender/reference/model_part.hpp>
#include <genrender/reference/single_file.hpp>
#include <genrender/reference/unet_config.hpp>
#include <genrender/reference/weights.hpp>

#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::reference {

/// What file names do not say of a pipeline.
struct pipeline_choice {
    std::string variant{};                       ///< of the weights in folders, say `fp16`; empty: see find_weights
    std::optional<prediction> prediction_type{}; ///< of a single file, where no tensor says it: see single_file
    bool keeps_file_width = false;               ///< whether weights of 16 bits stay so: see weights::keep_file_width
};

/// The networks of a pipeline, each in a folder of diffusers' layout or in a single file.
class pipeline_files {
    // Stands first because its type follows from its body.
    template <class Ask>
    auto with_holder(model_part part, Ask const& ask) const {
        if (part == model_part::controlnet) {
            return control_file_ ? ask(*control_file_) : has_control_folder_ ? ask(folder_) : ask(*file_);
        }
        return file_ ? ask(*file_) : ask(folder_);
    }

public:
    /// Reads the headers of single files and no file of folders yet. `controlnet` is by default what `pipeline` holds.
    /// Throws file_error as single_file does, or if there is nothing at a path.
    explicit pipeline_files(std::filesystem::path const& pipeline, std::filesystem::path const& controlnet = {},
                            pipeline_choice const& choice = {})
        : folder_(pipeline, std::filesystem::is_directory(controlnet) ? controlnet : std::filesystem::path(),
                  choice.variant),
          keeps_file_width_(choice.keeps_file_width) {
        if (!std::filesystem::is_directory(pipeline)) {
            file_.emplace(existing(pipeline), choice.prediction_type);
        }
        has_control_folder_ = std::filesystem::is_directory(controlnet) || (!file_ && controlnet.empty());
        if (!controlnet.empty() && !std::filesystem::is_directory(controlnet)) {
            control_file_.emplace(existing(controlnet));
        }
    }

    /// Whether it has a network.
    bool has(model_part part) const {
        return with_holder(part, [&](auto const& holder) { return holder.has(part); });
    }
    /// What config.json says of a network, or would say. Throws file_error if there is none.
    config_file options(model_part part) const {
        return with_holder(part, [&](auto const& holder) { return holder.options(part); });
    }
    /// What scheduler_config.json says, or would say. Throws file_error as single_file does, or if it cannot be read.
    config_file scheduler_options() const { return file_ ? file_->scheduler_options() : folder_.scheduler_options(); }
    /// The architecture of UNet and ControlNet. Throws as diffusers_folder::config does.
    unet_config config() const {
        if (!file_) {
            folder_.refuse_foreign();
        }
        auto unet = options(model_part::unet);
        auto controlnet = options(model_part::controlnet);
        return read_diffusers_config(std::move(unet), std::move(controlnet), scheduler_options());
    }
    /// Merges a LoRA, `scale` times, into the UNet and the text encoder that are built from now on. Throws file_error as
    /// lora_file does.
    void add_lora(std::filesystem::path const& path, double scale = 1) { loras_.emplace_back(lora_file(path), scale); }

    /// A network's tensors, to build it of, with all LoRAs. Throws file_error if there are none, or as
    /// reference::add_lora does.
    template <std::floating_point Real>
    weights<Real> tensors(model_part part) const {
        auto source = with_holder(part, [&](auto const& holder) { return holder.template tensors<Real>(part); });
        source.keep_file_width(keeps_file_width_);
        for (auto const& [lora, scale] : loras_) {
            reference::add_lora(source, lora, part, scale);
        }
        return source;
    }
    /// The folder, unless the pipeline is a single file.
    diffusers_folder const* folder() const { return file_ ? nullptr : &folder_; }

private:
    static std::filesystem::path const& existing(std::filesystem::path const& path) {
        if (!std::filesystem::exists(path)) {
            throw file_error(path.string() + ": there is nothing, expected a diffusers folder or a safetensors file");
        }
        return path;
    }

    diffusers_folder folder_;
    bool keeps_file_width_;
    bool has_control_folder_ = false;
    std::optional<single_file> file_;
    std::optional<single_file> control_file_;
    std::vector<std::pair<lora_file, double>> loras_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
