// SPDX-License-Identifier: MIT
// A file of glTF 2.0, as text or binary, with its buffers; pictures and materials are left out.
#pragma once

#include "gltf_values.hpp"

#include <genrender/core/error.hpp>

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace genrender::examples {

/// What a file of glTF 2.0 says, and its buffers' bytes.
struct gltf_document {
    std::string path;
    tinygltf::Model model;            ///< without images, textures, materials and extras
    std::vector<std::string> notes{}; ///< sentences

    /// Throws file_error that begins with the path: `PATH: what`.
    [[noreturn]] void refuse(std::string const& what) const { throw file_error(path + ": " + what); }
};

namespace detail {

/// A text of JSON and the bytes that may follow it in a binary file.
struct gltf_parts {
    std::string text;
    std::string binary;
};

[[noreturn]] inline void refuse_gltf(std::string const& path, std::string const& reason) {
    throw file_error(path + ": cannot be read as a model (" + reason + "), expected a whole file of glTF 2.0");
}

/// At most `most` bytes of a file; throws file_error where there are none.
inline std::string gltf_bytes(std::filesystem::path const& path, std::uintmax_t most) {
    std::error_code failure;
    auto const size = std::filesystem::file_size(path, failure); // of a folder or a device there is none
    std::ifstream stream(path, std::ios::binary);
    if (failure || !stream) {
        throw file_error("unable to open " + path.string());
    }
    std::string bytes(static_cast<std::size_t>(std::min(size, most)), '\0');
    if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
        throw file_error("unable to read " + path.string());
    }
    return bytes;
}

inline std::uint32_t gltf_word(std::string_view bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at + i))) << (8 * i);
    }
    return word;
}

/// A binary file begins with "glTF", its version and its length; then come chunks of a length, a kind and bytes.
inline gltf_parts gltf_parts_of(std::string bytes) {
    if (!bytes.starts_with("glTF")) {
        return {std::move(bytes), {}};
    }
    if (bytes.size() < 20 || gltf_word(bytes, 8) > bytes.size()) {
        throw file_error("it is cut off");
    }
    if (gltf_word(bytes, 4) != 2) {
        throw file_error("its container is of version " + std::to_string(gltf_word(bytes, 4)));
    }
    gltf_parts parts;
    std::size_t const end = gltf_word(bytes, 8);
    for (std::size_t at = 12, chunk = 0; at + 8 <= end && chunk < 2; ++chunk) {
        std::size_t const length = gltf_word(bytes, at);
        auto const kind = bytes.substr(at + 4, 4);
        if (length > end - at - 8) {
            throw file_error("chunk " + std::to_string(chunk) + " is cut off");
        }
        if (chunk == 0 && kind != "JSON") {
            throw file_error("its first chunk is not JSON");
        }
        if (chunk == 0) {
            parts.text = bytes.substr(at + 8, length);
        } else if (kind == std::string_view("BIN\0", 4)) {
            parts.binary = bytes.substr(at + 8, length);
        }
        at += 8 + (length + 3) / 4 * 4;
    }
    return parts;
}

/// The text as JSON, without what has nothing to do with shapes. Nothing that nests deeply is let through, as readers
/// go down by recursion.
inline nlohmann::json gltf_json(std::string const& text) {
    constexpr int most_levels = 64;
    static constexpr std::array left_out{"images", "textures", "materials", "extensions"};
    auto const keep = [](int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
        if (depth > most_levels) {
            throw file_error("it nests more than " + std::to_string(most_levels) + " levels");
        }
        if (event != nlohmann::json::parse_event_t::key) {
            return true;
        }
        auto const& key = parsed.get_ref<std::string const&>();
        return key != "extras" &&
               (depth > 1 || std::find(left_out.begin(), left_out.end(), std::string_view(key)) == left_out.end());
    };
    return nlohmann::json::parse(text, keep);
}

/// Whether an extension changes what surfaces look like and not where they are.
inline bool is_gltf_look(std::string_view extension) {
    static constexpr std::array<std::string_view, 8> families{"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                              "MSFT_texture_",  "KHR_lights_",  "EXT_lights_",
                                                              "KHR_xmp",        "KHR_technique"};
    return std::any_of(families.begin(), families.end(), [&](auto family) { return extension.starts_with(family); });
}

/// Throws file_error by name at an extension that a reader must know and this one does not.
inline void check_gltf_extensions(nlohmann::json const& json, gltf_document& document) {
    for (std::string const extension : json.value("extensionsRequired", nlohmann::json::array())) {
        if (extension == "KHR_draco_mesh_compression" || extension.find("meshopt") != std::string::npos) {
            document.refuse("its meshes are compressed by " + extension + ", expected a file exported without it");
        }
        if (extension != "KHR_mesh_quantization" && extension != "EXT_mesh_gpu_instancing" &&
            !is_gltf_look(extension)) {
            document.refuse("needs the extension " + extension + ", which is not known here, expected a file without");
        }
        if (extension == "KHR_texture_transform") {
            document.notes.push_back(
                "The file places its textures by KHR_texture_transform; UVs are left as they are.");
        }
    }
}

/// `%20` and the like as the bytes they stand for.
inline std::string without_percent(std::string_view uri) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        unsigned char byte = 0;
        auto const* const digits = uri.data() + i + 1;
        if (uri[i] == '%' && i + 2 < uri.size() && std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
            text += static_cast<char>(byte);
            i += 2;
        } else {
            text += uri[i];
        }
    }
    return text;
}

/// The bytes of one buffer, as many as it says.
inline tinygltf::Buffer gltf_buffer(nlohmann::json const& json, std::filesystem::path const& folder,
                                    std::string const* binary) {
    auto const size = json.at("byteLength").get<std::size_t>();
    auto const uri = json.value("uri", std::string());
    tinygltf::Buffer buffer;
    std::string mime_type;
    if (uri.empty() && binary != nullptr) {
        buffer.data.assign(binary->begin(), binary->end());
    } else if (auto const at = uri.find(";base64,"); uri.starts_with("data:") && at != std::string::npos) {
        // Whatever it calls itself, as the decoder knows only a few kinds
        auto const plain = "data:application/octet-stream" + uri.substr(at);
        tinygltf::DecodeDataURI(&buffer.data, mime_type, plain, 0, false);
    } else {
        auto const bytes = gltf_bytes(folder / without_percent(uri), size);
        buffer.data.assign(bytes.begin(), bytes.end());
    }
    if (buffer.data.size() < size) {
        throw file_error("a buffer has " + std::to_string(buffer.data.size()) + " of its " + std::to_string(size) +
                         " bytes");
    }
    buffer.data.resize(size);
    return buffer;
}

} // namespace detail

/// Reads a file of glTF 2.0. Throws file_error that begins with `path` if it is not one, is not whole, or needs an
/// extension that is not known here. Numbers of things in it (accessors, nodes) are not checked yet.
inline gltf_document read_gltf(std::filesystem::path const& path) {
    gltf_document document{path.string(), {}};
    std::string reason, warnings;
    nlohmann::json json;
    detail::gltf_parts parts;
    try {
        parts = detail::gltf_parts_of(detail::gltf_bytes(path, std::uintmax_t{1} << 32));
        json = detail::gltf_json(parts.text);
        auto const version = json.at("asset").at("version").get<std::string>();
        auto const least = json.at("asset").value("minVersion", std::string("2.0"));
        if (!version.starts_with("2.") || least != "2.0") {
            throw file_error("it is of version " + version);
        }
    } catch (std::exception const& failure) {
        detail::refuse_gltf(document.path, failure.what());
    }
    try {
        detail::check_gltf_extensions(json, document);
        check_gltf_values(json);
        auto const buffers = json.value("buffers", nlohmann::json::array());
        json.erase("buffers");
        auto const text = json.dump();
        tinygltf::TinyGLTF reader;
        if (!reader.LoadASCIIFromString(&document.model, &reason, &warnings, text.c_str(),
                                        static_cast<unsigned>(text.size()), path.parent_path().string())) {
            detail::refuse_gltf(document.path, reason);
        }
        for (auto const& buffer : buffers) {
            auto const is_binary = document.model.buffers.empty() && !parts.binary.empty();
            document.model.buffers.push_back(
                detail::gltf_buffer(buffer, path.parent_path(), is_binary ? &parts.binary : nullptr));
        }
    } catch (file_error const& failure) {
        if (std::string_view(failure.what()).starts_with(document.path + ": ")) {
            throw;
        }
        detail::refuse_gltf(document.path, failure.what());
    } catch (std::exception const& failure) { // of JSON: a number where a name should be, and the like
        detail::refuse_gltf(document.path, failure.what());
    }
    return document;
}

} // namespace genrender::examples
