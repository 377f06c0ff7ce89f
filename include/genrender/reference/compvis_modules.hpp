// SPDX-License-Identifier: MIT
// Modules of CompVis' UNet as kohya's LoRA files name them, underscores for dots, in the names of diffusers.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/reference/compvis_names.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace genrender::reference {

/// A name with underscores for its dots.
inline std::string underscored(std::string_view name) {
    std::string result(name);
    std::replace(result.begin(), result.end(), '.', '_');
    return result;
}

namespace internal {

/// Takes `count` numbers with an underscore behind each off the beginning of a name, and appends them with dots.
inline bool take_underscored_numbers(std::string_view& name, std::size_t count, std::string& dotted) {
    for (std::size_t i = 0; i < count; ++i) {
        auto const digits = name.find('_');
        if (digits == 0 || digits > 3 || name.find_first_not_of("0123456789") != digits) {
            return false;
        }
        dotted += std::string(name.substr(0, digits)) + ".";
        name.remove_prefix(digits + 1);
    }
    return true;
}

/// Takes what one of the rules is for off the beginning of a name and appends it with its dots.
inline bool take_underscored_rule(std::string_view& name, std::span<name_rule const> rules, std::string& dotted) {
    for (auto const& rule : rules) {
        auto const from = rule.from.substr(0, rule.from.size() - 1);
        auto const text = underscored(from);
        if (name == text || name.starts_with(text + "_")) {
            dotted += rule.from;
            name.remove_prefix(std::min(name.size(), text.size() + 1));
            return true;
        }
    }
    return false;
}

} // namespace internal

/// The module `input_blocks_1_1_proj_in` of a UNet with `layers` resnets a level on its way down is
/// `down_blocks_0_attentions_0_proj_in`; nothing if the name is not CompVis'.
inline std::optional<std::string> diffusers_module(std::string_view name, std::size_t layers = 2) {
    static constexpr std::array<internal::name_rule, 2> samplers{{{"op.", ""}, {"conv.", ""}}};
    std::string dotted;
    auto const take_place = [&] {
        for (auto const& [head, numbers] :
             {std::pair{"input_blocks", 2U}, {"output_blocks", 2U}, {"middle_block", 1U}}) {
            if (internal::take_prefix(name, std::string(head) + "_")) {
                dotted = std::string(head) + ".";
                return internal::take_underscored_numbers(name, numbers, dotted);
            }
        }
        return false;
    };
    if (!internal::take_underscored_rule(name, internal::unet_rules, dotted)) {
        if (!take_place() || !(internal::take_underscored_rule(name, internal::resnet_rules, dotted) ||
                               internal::take_underscored_rule(name, internal::attention_rules, dotted) ||
                               internal::take_underscored_rule(name, samplers, dotted))) {
            return std::nullopt;
        }
    }
    auto found = internal::unet_name(dotted + std::string(name), layers, false);
    if (!found) {
        return std::nullopt;
    }
    if (found->ends_with('.')) {
        found->pop_back();
    }
    return underscored(*found);
}

} // namespace genrender::reference

#include <genrender/core/end_header.inl>
