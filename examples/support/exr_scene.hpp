// SPDX-License-Identifier: MIT
// What examples/blender/genrender_maps.py says beside the EXR files that it writes: frame rate, camera, objects' names.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/reference/checked_json.hpp>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <system_error>

namespace genrender::examples {

/// What is known of the scene that maps show.
struct exr_scene {
    std::optional<double> frames_per_second;      ///< of the files as they follow each other, above 0
    std::string camera;                           ///< its name; empty if nobody says
    std::map<std::uint32_t, std::string> objects; ///< names by the maps' object indices
};

namespace detail {

/// A whole number of 32 bits from all of a text.
inline std::optional<std::uint32_t> whole_number(std::string const& text, int base) {
    std::uint32_t number = 0;
    auto const* const end = text.data() + text.size();
    auto const [rest, error] = std::from_chars(text.data(), end, number, base);
    return error == std::errc() && rest == end && !text.empty() ? std::optional(number) : std::nullopt;
}

} // namespace detail

/// The scene.json of `folder`, or nothing where there is none. Throws file_error that names the file and the key for a
/// text that is no JSON object, a frame rate or step that is not above 0, and objects that are not names by index.
inline std::optional<exr_scene> load_exr_scene(std::filesystem::path const& folder) {
    auto const path = (folder / "scene.json").string();
    std::ifstream stream(path, std::ios::binary);
    if (!stream) {
        return std::nullopt;
    }
    std::string const text{std::istreambuf_iterator<char>(stream), {}};
    auto const json = reference::checked_json(text, path, "the file", "what genrender_maps.py writes");
    auto const require = [&](bool holds, char const* key, nlohmann::json const& found, char const* expected) {
        if (!holds) {
            throw file_error(path + ": " + key + " is " +
                             found.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).substr(0, 60) +
                             ", expected " + expected);
        }
    };
    require(json.is_object(), "the file", json, "an object");

    exr_scene scene;
    auto const number = [&](char const* key, double otherwise) {
        if (!json.contains(key)) {
            return otherwise;
        }
        auto const& value = json[key];
        require(value.is_number() && value.get<double>() > 0 && value.get<double>() < 1e6, key, value,
                "a number above 0");
        return value.get<double>();
    };
    auto const rate = number("frames_per_second", 0);
    auto const step = number("step", 1);
    if (rate > 0) {
        scene.frames_per_second = rate / step;
    }
    if (json.contains("camera")) {
        auto const& camera = json["camera"];
        require(camera.is_object() && camera.contains("name") && camera["name"].is_string(), "camera", camera,
                "an object with a name");
        scene.camera = camera["name"].get<std::string>();
    }
    if (json.contains("objects")) {
        auto const& objects = json["objects"];
        require(objects.is_object(), "objects", objects, "names by index");
        for (auto const& [key, name] : objects.items()) {
            auto const index = detail::whole_number(key, 10);
            require(index && name.is_string(), "objects", objects, "names by index");
            scene.objects.emplace(*index, name.get<std::string>());
        }
    }
    return scene;
}

/// Names by object index from a manifest of Cryptomatte; none if the text is empty. Throws file_error that names `path`
/// for a text that is no JSON object of hexadecimal ids.
inline std::map<std::uint32_t, std::string> names_in_manifest(std::string const& manifest, std::string const& path) {
    std::map<std::uint32_t, std::string> names;
    if (manifest.empty()) {
        return names;
    }
    auto const json =
        reference::checked_json(manifest, path, "the manifest of Cryptomatte", "names and hexadecimal ids");
    for (auto const& [name, id] : json.items()) {
        auto const number = id.is_string() ? detail::whole_number(id.get<std::string>(), 16) : std::nullopt;
        if (!json.is_object() || !number) {
            throw file_error(path + ": the manifest of Cryptomatte has for " + name + " no hexadecimal id, expected " +
                             "names and hexadecimal ids");
        }
        names.emplace(*number, name);
    }
    return names;
}

} // namespace genrender::examples
