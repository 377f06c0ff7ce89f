// SPDX-License-Identifier: MIT
// Cryptomatte as object indices: of the objects that share a pixel, the one that covers most of it.
#pragma once

#include "exr_frame.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

// Cryptomatte specification 1.2.0: channels TYPE00.r, g, b, a, TYPE01.r, ... hold pairs of an id, the bits of a float,
// and the share of the pixel that the object covers. Blender's name for the matte of objects is CryptoObject.

namespace genrender::examples {

/// The channels of a Cryptomatte of objects: id, coverage, id, coverage, ... [even number]; empty if `layer` has none.
/// Throws file_error if ids are 16-bit floats, which hold no id.
inline std::vector<exr_channel> find_cryptomatte(exr_frame const& frame, std::string const& layer) {
    static std::array<std::array<char const*, 4>, 2> const spellings{
        {{"r", "g", "b", "a"}, {"red", "green", "blue", "alpha"}}};
    std::vector<exr_channel> channels;
    for (std::string const type : {"CryptoObject", "crypto_object", "CryptoAsset"}) {
        for (auto const& components : spellings) {
            for (int level = 0; level < 10; ++level) {
                auto const prefix = (layer.empty() ? "" : layer + ".") + type + "0" + std::to_string(level) + ".";
                for (std::size_t pair = 0; pair < 4; pair += 2) {
                    auto const* const id = frame.find(prefix + components[pair]);
                    auto const* const coverage = frame.find(prefix + components[pair + 1]);
                    if (id != nullptr && coverage != nullptr) {
                        channels.push_back(*id);
                        channels.push_back(*coverage);
                        if (id->type != Imf::FLOAT) {
                            throw file_error(frame.path().string() + ": channel " + id->name +
                                             " does not hold 32-bit floats, expected them (ids of Cryptomatte are "
                                             "their bits)");
                        }
                    }
                }
            }
            if (!channels.empty()) {
                return channels;
            }
        }
    }
    return channels;
}

/// An object and its share of a pixel.
struct cryptomatte_object {
    std::uint32_t id = 0; ///< 0: none
    float coverage = 0;
};

/// The object of the largest coverage at a pixel; `planes` are those of `find_cryptomatte`'s channels.
inline cryptomatte_object largest_object(std::span<std::vector<float> const> planes, std::size_t pixel) {
    cryptomatte_object largest;
    for (std::size_t i = 0; i + 1 < planes.size(); i += 2) {
        if (planes[i + 1][pixel] > largest.coverage) {
            largest = {std::bit_cast<std::uint32_t>(planes[i][pixel]), planes[i + 1][pixel]};
        }
    }
    return largest;
}

/// The manifest of a layer's Cryptomatte of objects, JSON text of names and hexadecimal ids; empty if the headers have
/// none.
inline std::string cryptomatte_manifest(exr_frame const& frame, std::string const& layer) {
    auto const texts = frame.texts();
    auto const prefix = layer.empty() ? std::string{} : detail::lower_case(layer) + ".";
    for (auto const& [name, text] : texts) {
        if (name.starts_with("cryptomatte/") && name.ends_with("/name")) {
            auto const type = detail::lower_case(text);
            auto const manifest = texts.find(name.substr(0, name.size() - 4) + "manifest");
            if (manifest != texts.end() && (type == prefix + "cryptoobject" || type == prefix + "crypto_object" ||
                                            type == prefix + "cryptoasset")) {
                return manifest->second;
            }
        }
    }
    return "";
}

} // namespace genrender::examples
