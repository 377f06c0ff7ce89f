// SPDX-License-Identifier: MIT
// Which of a network's weights each difference of a LoRA is of.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/reference/compvis_modules.hpp>
#include <genrender/reference/lora_difference.hpp>
#include <genrender/reference/lora_file.hpp>
#include <genrender/reference/tensor_place.hpp>
#include <genrender/reference/weights.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace genrender::reference {

namespace internal {

/// Names with underscores for dots, and the weights that they may mean.
inline std::multimap<std::string, std::string> underscored_names(tensor_places const& places) {
    std::multimap<std::string, std::string> names;
    for (auto const& [name, place] : places) {
        if (name.ends_with(".weight") && place.shape.size() >= 2) {
            names.emplace(underscored(std::string_view(name).substr(0, name.rfind('.'))), name);
        }
    }
    return names;
}

/// Resnets a level on the way down of the UNet whose weights these are, 0 for other networks.
inline std::size_t down_layers(tensor_places const& places) {
    std::size_t layers = 0;
    while (places.contains("down_blocks.0.resnets." + std::to_string(layers) + ".conv1.weight")) {
        ++layers;
    }
    return layers;
}

/// Throws file_error unless a difference has the shape of its weight.
inline void require_fits(lora_file const& lora, std::string const& name, tensor_place const& weight,
                         lora_difference const& difference) {
    auto const& down = difference.down.shape;
    auto const& up = difference.up.shape;
    auto const& shape = weight.shape;
    auto const fits = shape.size() >= 2 && up[0] == shape[0] && down[1] == shape[1] &&
                      difference.down.count() / down[0] == weight.count() / std::max<std::size_t>(1, shape[0]) &&
                      (down.size() == 2 || shape.size() == 2 ||
                       std::equal(down.begin() + 2, down.end(), shape.begin() + 2, shape.end()));
    if (!fits) {
        throw file_error(lora.path() + ": factors of " + difference.down.stored + " are " + extents_text(down) +
                         " and " + extents_text(up) + ", expected those of " + name + " " + extents_text(shape));
    }
}

} // namespace internal

/// The differences that a LoRA has for one network, whose weights are `places`. A name with underscores, as kohya writes
/// it, is that of the weight whose name is the same with underscores for dots, or was in CompVis' UNet. Throws file_error
/// naming modules that the network does not have, or that may be two; and factors that do not have the shape of their
/// weight.
inline lora_differences differences_of(lora_file const& lora, model_part part, tensor_places const& places) {
    auto const by_underscores = internal::underscored_names(places);
    auto const layers = internal::down_layers(places);
    lora_differences result;
    counted_names unknown;
    std::size_t count = 0;
    for (auto const& module : lora.modules()) {
        if (module.part != part) {
            continue;
        }
        ++count;
        std::string name = module.name + ".weight";
        if (module.is_underscored) {
            auto const compvis = part == model_part::unet ? diffusers_module(module.name, layers) : std::nullopt;
            auto const [first, last] = by_underscores.equal_range(compvis.value_or(module.name));
            if (first != last && std::next(first) != last) {
                throw file_error(lora.path() + ": module " + module.name + " may be " + first->second + " or " +
                                 std::next(first)->second + ", expected one");
            }
            name = first == last ? "" : first->second;
        } else if (part == model_part::text_encoder && !name.starts_with("text_model.")) {
            name = "text_model." + name;
        }
        auto const found = places.find(name);
        if (found == places.end()) {
            unknown.add(module.name);
            continue;
        }
        internal::require_fits(lora, name, found->second, module.difference);
        result.emplace(name, module.difference);
    }
    if (unknown.count() > 0) {
        throw file_error(lora.path() + ": " + std::to_string(unknown.count()) + " of " + std::to_string(count) +
                         " modules have no place in the " + name_of(part) + ": " + unknown.text() + ", expected none");
    }
    return result;
}

/// Adds what a LoRA changes in one network, `scale` times, to the tensors that are taken from its weights from now on;
/// several LoRAs add up. Throws value_error if tensors are random or the scale is not finite, file_error as
/// differences_of does.
template <std::floating_point Real>
void add_lora(weights<Real>& source, lora_file const& lora, model_part part, double scale = 1) {
    require_value(source.stored_count() > 0, "add_lora", "tensors", "random", "of files, where a LoRA is to be merged");
    source.add_differences(differences_of(lora, part, source.places()), scale);
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
