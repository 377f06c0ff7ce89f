// SPDX-License-Identifier: MIT
// A LoRA (Hu et al. 2021): low-rank differences of a model's weights, in the names of kohya, PEFT and diffusers.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/reference/checked_json.hpp>
#include <genrender/reference/lora_difference.hpp>
#include <genrender/reference/model_part.hpp>
#include <genrender/reference/pickles.hpp>
#include <genrender/reference/safetensors.hpp>
#include <genrender/reference/tensor_place.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
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

/// The module of a weight, and its difference.
struct lora_module {
    model_part part;            ///< the network that it is of
    std::string name;           ///< the module there: dots between its parts, or underscores for them
    bool is_underscored;        ///< which of both
    lora_difference difference; ///< what is added
};

namespace internal {

inline constexpr std::string_view lora_downs[] = {".lora_down.weight",      ".lora_A.weight",
                                                  ".lora_A.default.weight", ".lora.down.weight",
                                                  "_lora.down.weight",      ".lora_linear_layer.down.weight"};
inline constexpr std::string_view lora_ups[] = {".lora_up.weight", ".lora_B.weight",  ".lora_B.default.weight",
                                                ".lora.up.weight", "_lora.up.weight", ".lora_linear_layer.up.weight"};

/// Part of a tensor's name by which another kind of difference is known.
struct foreign_difference {
    std::string_view part;
    char const* what;
};

inline constexpr foreign_difference foreign_differences[] = {
    {".dora_scale", "DoRA"},
    {"lora_magnitude_vector", "DoRA"},
    {".hada_w", "LoHa"},
    {".lokr_w", "LoKr"},
    {".oft_", "OFT"},
    {".lora_mid.", "LoCon in its Tucker form"},
    {".diff", "differences of full rank"},
    {".on_input", "IA3"},
    {".lora_up.bias", "LoRA with biases"},
    {".lora_B.bias", "LoRA with biases"},
    {"lora_te1_", "a LoRA of Stable Diffusion XL, which has two text encoders,"},
    {"lora_te2_", "a LoRA of Stable Diffusion XL, which has two text encoders,"},
    {"text_encoder_2.", "a LoRA of Stable Diffusion XL, which has two text encoders,"},
    {"lora_transformer_", "a LoRA of a transformer (Stable Diffusion 3, Flux)"}};

/// The name without one of these endings, if it has one.
template <std::size_t Count>
std::optional<std::string_view> without_ending(std::string_view name, std::string_view const (&endings)[Count]) {
    for (auto const ending : endings) {
        if (name.ends_with(ending)) {
            return name.substr(0, name.size() - ending.size());
        }
    }
    return std::nullopt;
}

} // namespace internal

/// The differences in a file. Linear layers and convolutions (LoCon) have one. Which of a model's weights they belong
/// to is found when they are merged (see add_lora).
class lora_file {
public:
    /// Reads the header and the scales. Throws file_error if it is a pickle or no safetensors file; for DoRA, LoHa, LoKr
    /// and other kinds of difference by name; for tensors whose names are unknown; for half a difference; for factors
    /// that do not fit each other.
    explicit lora_file(std::filesystem::path const& path) : path_(path.string()) {
        refuse_pickle(path);
        auto const file = std::make_shared<safetensors_file const>(path_);
        refuse_foreign(*file);
        struct found_tensors {
            std::string down, up, alpha;
        };
        std::map<std::string, found_tensors, std::less<>> found;
        counted_names unknown;
        for (auto const& [name, entry] : file->entries()) {
            static constexpr std::string_view alphas[] = {".alpha"};
            if (auto const of_down = internal::without_ending(name, internal::lora_downs)) {
                set(found[std::string(*of_down)].down, name);
            } else if (auto const of_up = internal::without_ending(name, internal::lora_ups)) {
                set(found[std::string(*of_up)].up, name);
            } else if (auto const of_alpha = internal::without_ending(name, alphas)) {
                set(found[std::string(*of_alpha)].alpha, name);
            } else {
                unknown.add(name);
            }
        }
        require(unknown.count() == 0, std::to_string(unknown.count()) + " tensors are unknown: " + unknown.text(),
                "lora_down, lora_up and alpha, or lora_A and lora_B, of modules");
        counted_names halves;
        for (auto const& [module, names] : found) {
            if (names.down.empty() || names.up.empty()) {
                halves.add(module);
            }
        }
        require(halves.count() == 0,
                std::to_string(halves.count()) + " modules have half a difference: " + halves.text(),
                "both factors of each");
        require(!found.empty(), "file holds no difference", "some");
        read_adapter_options(*file);
        for (auto const& [module, names] : found) {
            add(file, module, names.down, names.up, names.alpha);
        }
    }

    /// Path of the file that it was read from.
    std::string const& path() const { return path_; }
    /// What it holds, in the order of the names there.
    std::vector<lora_module> const& modules() const { return modules_; }

private:
    void require(bool holds, std::string const& found, std::string const& expected) const {
        if (!holds) {
            throw file_error(path_ + ": " + found + ", expected " + expected);
        }
    }

    void refuse_foreign(safetensors_file const& file) const {
        for (auto const& [part, what] : internal::foreign_differences) {
            for (auto const& [name, entry] : file.entries()) {
                require(name.find(part) == std::string::npos, "file holds " + std::string(what) + " (" + name + ")",
                        "low-rank differences of Stable Diffusion 1.x or 2.x alone");
            }
        }
    }

    void set(std::string& to, std::string const& name) const {
        require(to.empty(), "tensors " + to + " and " + name + " are the same factor", "one");
        to = name;
    }

    /// PEFT keeps alpha beside the tensors: for each network one, and others for some modules.
    void read_adapter_options(safetensors_file const& file) {
        auto const found = file.metadata().find("lora_adapter_metadata");
        if (found == file.metadata().end()) {
            return;
        }
        options_ = checked_json(found->second, path_, "lora_adapter_metadata", "an object of options");
        require(options_.is_object(), "lora_adapter_metadata is a JSON " + std::string(options_.type_name()),
                "an object of options");
        for (auto const* network : {"unet.", "text_encoder."}) {
            for (auto const* option : {"use_dora", "use_rslora"}) {
                auto const at = options_.find(std::string(network) + option);
                require(at == options_.end() || *at == false || at->is_null(),
                        "lora_adapter_metadata has " + std::string(network) + option, "false");
            }
        }
    }

    /// Alpha by PEFT's options, if it has some.
    std::optional<double> adapter_alpha(std::string const& network, std::string const& module) const {
        auto const patterns = options_.find(network + "alpha_pattern");
        if (patterns != options_.end() && patterns->is_object()) {
            for (auto const& [pattern, value] : patterns->items()) {
                if (value.is_number() && (module == pattern || module.ends_with("." + pattern))) {
                    return value.get<double>();
                }
            }
        }
        auto const alpha = options_.find(network + "lora_alpha");
        return alpha != options_.end() && alpha->is_number() ? std::optional(alpha->get<double>()) : std::nullopt;
    }

    void add(std::shared_ptr<safetensors_file const> const& file, std::string module, std::string const& down,
             std::string const& up, std::string const& alpha) {
        auto const place = [&](std::string const& name) {
            return tensor_place{file, name, file->entry(name).shape, 0};
        };
        lora_module result{model_part::unet, {}, false, {place(down), place(up), 1}};
        auto const& down_shape = result.difference.down.shape;
        auto const& up_shape = result.difference.up.shape;
        auto const fits = down_shape.size() >= 2 && up_shape.size() >= 2 && down_shape[0] == up_shape[1] &&
                          down_shape[0] > 0 &&
                          std::all_of(up_shape.begin() + 2, up_shape.end(), [](auto extent) { return extent == 1; });
        require(fits, "factors of " + module + " are " + extents_text(down_shape) + " and " + extents_text(up_shape),
                "[rank, in, ...] and [out, rank]");
        result.name = module_name(module, result);
        auto const rank = static_cast<double>(down_shape[0]);
        auto value = alpha.empty()
                         ? adapter_alpha(result.part == model_part::unet ? "unet." : "text_encoder.", result.name)
                         : std::nullopt;
        if (!alpha.empty()) {
            require(place(alpha).count() == 1, "tensor " + alpha + " is " + extents_text(place(alpha).shape),
                    "one number");
            value = place(alpha).read<double>().front();
        }
        result.difference.factor = value.value_or(rank) / rank;
        require(is_finite(result.difference.factor), "alpha of " + module + " is not finite", "a finite number");
        modules_.push_back(std::move(result));
    }

    /// Finds the network of a module and takes what says so off its name.
    static std::string module_name(std::string_view name, lora_module& module) {
        auto const take = [&](std::string_view prefix) {
            auto const has = name.starts_with(prefix);
            name.remove_prefix(has ? prefix.size() : 0);
            return has;
        };
        auto const is_kohya_unet = take("lora_unet_");
        if (is_kohya_unet || take("lora_te_")) {
            module.is_underscored = true;
            module.part = is_kohya_unet ? model_part::unet : model_part::text_encoder;
            return std::string(name);
        }
        take("base_model.model.");
        auto const is_unet = take("unet.");
        module.part = !is_unet && (take("text_encoder.") || name.starts_with("text_model.")) ? model_part::text_encoder
                                                                                             : model_part::unet;
        std::string result(name);
        // Differences once were layers of diffusers' attention processors.
        if (auto const at = result.find(".processor.to_"); at != std::string::npos) {
            result.erase(at, std::string_view(".processor").size());
            result += result.ends_with(".to_out") ? ".0" : "";
        }
        return result;
    }

    std::string path_;
    nlohmann::json options_ = nlohmann::json::object();
    std::vector<lora_module> modules_;
};

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
