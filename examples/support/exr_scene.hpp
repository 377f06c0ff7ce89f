// SPDX-License-Identifier: MIT
// What examples/blender/genrender_maps.py says beside the EXR files that it writes: frame rate, camera, objects' names.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/reference/checked_json.hpp>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace genrender::examples {

/// A perspective camera of one frame.
struct exr_camera {
    glm::dmat3 to_world{1}; ///< its axes: right, up and backwards
    double x_scale = 1; ///< x / -z of the image's right border is (1 + x_shift) / x_scale, of the left (-1 + x_shift)
    double y_scale = 1; ///< the same of its upper border
    double x_shift = 0;
    double y_shift = 0;

    /// Where an image position looks, each of its coordinates 0 to 1 from the upper left corner; in the world, of any
    /// length.
    glm::dvec3 direction(double row, double column) const {
        return to_world * glm::dvec3((2 * column - 1 + x_shift) / x_scale, (1 - 2 * row + y_shift) / y_scale, -1);
    }
};

/// What is known of the scene that maps show.
struct exr_scene {
    std::optional<double> frames_per_second;      ///< of the files as they follow each other, above 0
    std::string camera;                           ///< its name; empty if nobody says
    std::map<long, exr_camera> cameras;           ///< by the files' numbers, where they are perspective ones
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

/// A matrix of four rows, or nothing for what is none.
inline std::optional<std::array<std::array<double, 4>, 4>> matrix_of(nlohmann::json const& json) {
    std::array<std::array<double, 4>, 4> matrix{};
    auto const is_four = [](nlohmann::json const& list) { return list.is_array() && list.size() == 4; };
    if (!is_four(json) || !std::all_of(json.begin(), json.end(), is_four)) {
        return std::nullopt;
    }
    for (std::size_t row = 0; row < 4; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            auto const& value = json[row][column];
            if (!value.is_number() || !std::isfinite(value.get<double>())) {
                return std::nullopt;
            }
            matrix[row][column] = value.get<double>();
        }
    }
    return matrix;
}

/// The camera of one of camera.frames, nothing if it is no perspective one. Throws through `require`.
inline std::optional<std::pair<long, exr_camera>> camera_of(nlohmann::json const& json, auto const& require) {
    auto const has = [&](char const* key) { return json.is_object() && json.contains(key); };
    require(has("frame") && json["frame"].is_number_integer() && has("camera_to_world") && has("projection"),
            "camera.frames", json, "entries with frame, camera_to_world and projection");
    if (json["projection"].is_null()) { // a panorama
        return std::nullopt;
    }
    auto const place = matrix_of(json["camera_to_world"]);
    auto const projection = matrix_of(json["projection"]);
    require(place && projection, "camera.frames", json, "matrices of 4 rows of 4 numbers");
    auto const& p = *projection;
    if (p[3][2] != -1 || p[3][3] != 0 || !(p[0][0] > 0) || !(p[1][1] > 0)) {
        return std::nullopt;
    }
    exr_camera camera;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            camera.to_world[column][row] = (*place)[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
        }
    }
    camera.x_scale = p[0][0];
    camera.y_scale = p[1][1];
    camera.x_shift = p[0][2];
    camera.y_shift = p[1][2];
    return std::pair(json["frame"].get<long>(), camera);
}

} // namespace detail

/// The scene.json of `folder`, or nothing where there is none. Throws file_error that names the file and the key for a
/// text that is no JSON object, a frame rate or step that is not above 0, cameras without place or projection, and
/// objects that are not names by index.
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
        auto const frames = camera.value("frames", nlohmann::json::array());
        require(frames.is_array(), "camera.frames", frames, "a list");
        for (auto const& frame : frames) {
            if (auto const found = detail::camera_of(frame, require)) {
                scene.cameras.insert(*found);
            }
        }
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
