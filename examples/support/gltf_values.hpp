// SPDX-License-Identifier: MIT
// Whether the values in the text of a glTF file are of the kinds that the format gives them, as readers skip others.
#pragma once

#include <genrender/core/error.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace genrender::examples {

namespace detail {

template <std::size_t N>
bool is_among(std::array<std::string_view, N> const& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Indices of things, and sizes.
inline bool is_gltf_whole(nlohmann::json const& value, std::string_view key) {
    static constexpr std::array<std::string_view, 3> sizes{"byteLength", "byteOffset", "count"};
    constexpr std::uint64_t most_things = INT32_MAX;
    return value.is_number_unsigned() && (is_among(sizes, key) || value.get<std::uint64_t>() <= most_things);
}

} // namespace detail

/// Throws file_error that names the property at a value of another kind than the format says: a text for a number, a
/// fraction for an index, one thing for a list; and at a primitive without attributes or a channel without a sampler.
/// Extensions are passed over.
inline void check_gltf_values(nlohmann::json const& json, bool is_root = true) {
    using names = std::string_view;
    static constexpr std::array<names, 9> root_lists{"accessors", "animations", "bufferViews", "buffers", "cameras",
                                                     "meshes",    "nodes",      "scenes",      "skins"};
    static constexpr std::array<names, 3> lists{"primitives", "samplers", "channels"};
    static constexpr std::array<names, 20> whole{
        "buffer", "bufferView", "byteLength", "byteOffset", "byteStride", "camera", "componentType",
        "count",  "indices",    "input",      "mesh",       "mode",       "node",   "inverseBindMatrices",
        "output", "sampler",    "scene",      "skin",       "skeleton",   "target"};
    static constexpr std::array<names, 3> whole_lists{"children", "joints", "nodes"};
    static constexpr std::array<names, 5> number_lists{"matrix", "rotation", "scale", "translation", "weights"};
    static constexpr std::array<names, 4> texts{"interpolation", "path", "type", "uri"};
    auto const require = [](bool is_right, std::string const& key, char const* kind) {
        if (!is_right) {
            throw file_error(key + " is not " + kind);
        }
    };
    auto const is_list = [](nlohmann::json const& value, auto const& is_right) {
        return value.is_array() && std::all_of(value.begin(), value.end(), is_right);
    };
    for (auto const& property : json.items()) {
        auto const& key = property.key();
        auto const& value = property.value();
        auto const is_index = [&](nlohmann::json const& one) { return detail::is_gltf_whole(one, key); };
        if (key == "extensions") {
            continue;
        }
        if (is_root ? detail::is_among(root_lists, key) : detail::is_among(lists, key)) {
            require(is_list(value, [](auto const& one) { return one.is_object(); }), key, "a list of things");
            for (auto const& one : value) {
                require(key != "primitives" || one.contains("attributes"), key, "a list of things with attributes");
                require(key != "channels" || one.contains("sampler"), key, "a list of things with a sampler");
                check_gltf_values(one, false);
            }
        } else if (key == "attributes" || key == "targets") {
            auto const is_named = [&](nlohmann::json const& one) {
                return one.is_object() && std::all_of(one.begin(), one.end(), is_index);
            };
            require(key == "targets" ? is_list(value, is_named) : is_named(value), key, "a table of whole numbers");
        } else if (value.is_object()) { // also the indices of a sparse accessor and the target of a channel
            check_gltf_values(value, false);
        } else if (detail::is_among(whole, key)) {
            require(is_index(value), key, "a whole number of at least 0");
        } else if (detail::is_among(whole_lists, key)) {
            require(is_list(value, is_index), key, "a list of whole numbers of at least 0");
        } else if (detail::is_among(number_lists, key)) {
            require(is_list(value, [](auto const& one) { return one.is_number(); }), key, "a list of numbers");
        } else if (detail::is_among(texts, key)) {
            require(value.is_string(), key, "a text");
        }
    }
}

} // namespace genrender::examples
