// SPDX-License-Identifier: MIT
// Names of choices on the command line and in reports, each beside its value.
#pragma once

#include <genrender/attention/feature_storage.hpp>
#include <genrender/core/error.hpp>
#include <genrender/noise/initial_noise.hpp>
#include <genrender/sampling/preconditioning.hpp>
#include <genrender/sampling/sampler.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// A value and its name.
template <class Enum>
struct named {
    std::string_view name;
    Enum value;
};

/// How the animation is rendered: the paper's method, or a baseline of its comparison.
enum class render_method : std::uint8_t { generative_rendering, per_frame, pix2video, tokenflow };

inline constexpr named<render_method> method_names[]{{"generative_rendering", render_method::generative_rendering},
                                                     {"per_frame", render_method::per_frame},
                                                     {"pix2video", render_method::pix2video},
                                                     {"tokenflow", render_method::tokenflow}};
inline constexpr named<sampler_kind> sampler_names[]{
    {"euler", sampler_kind::euler}, {"heun", sampler_kind::heun}, {"dpmpp_2m", sampler_kind::dpmpp_2m}};
inline constexpr named<noise_kind> noise_names[]{
    {"uv", noise_kind::uv}, {"fixed", noise_kind::fixed}, {"independent", noise_kind::independent}};
inline constexpr named<feature_storage> storage_names[]{
    {"same", feature_storage::same}, {"float16", feature_storage::f16}, {"bfloat16", feature_storage::bf16}};
inline constexpr named<prediction> prediction_type_names[]{{"epsilon", prediction::epsilon},
                                                           {"v_prediction", prediction::velocity}};

/// The name of a value. Throws value_error if it has none.
template <class Enum, std::size_t count>
std::string name_in(named<Enum> const (&names)[count], Enum value) {
    for (auto const& one : names) {
        if (one.value == value) {
            return std::string(one.name);
        }
    }
    throw value_error("name_in: value is " + std::to_string(static_cast<int>(value)) + ", expected one with a name");
}

/// The value of a name. Throws value_error if none has it.
template <class Enum, std::size_t count>
Enum value_in(named<Enum> const (&names)[count], std::string_view name) {
    for (auto const& one : names) {
        if (one.name == name) {
            return one.value;
        }
    }
    throw value_error("value_in: name is " + std::string(name) + ", expected one of the list");
}

/// All names, in their order.
template <class Enum, std::size_t count>
std::vector<std::string> all_names(named<Enum> const (&names)[count]) {
    std::vector<std::string> all;
    for (auto const& one : names) {
        all.emplace_back(one.name);
    }
    return all;
}

} // namespace genrender::examples
