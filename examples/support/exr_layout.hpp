// SPDX-License-Identifier: MIT
// Where UV, object, depth and rest position lie in an EXR file: Blender's render passes, or four plainly named
// channels.
#pragma once

#include "exr_file.hpp"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// How the channels of a file are named.
enum class exr_layout {
    blender, ///< `LAYER.UV.U`, `LAYER.UV.V`, `LAYER.UV.A`, `LAYER.Depth.Z`, `LAYER.IndexOB.X` of a multilayer file
    plain    ///< `u`, `v`, `id`, `depth`
};

/// The channels of one file that hold the maps.
struct exr_map_channels {
    exr_layout layout = exr_layout::blender;
    std::string layer; ///< what stands before `.UV.U`; empty in the plain layout
    exr_channel u;
    exr_channel v;
    exr_channel object;
    exr_channel depth;
    std::optional<exr_channel> alpha;  ///< 0 where no surface was hit
    std::vector<exr_channel> position; ///< x, y and z of the surface point; empty if the file has none
};

namespace detail {

/// The spellings of a pass; Blender renamed passes and components over the years, the first is today's most common.
struct exr_pass_names {
    char const* what;
    std::vector<std::string> names;
};

inline std::array<exr_pass_names, 4> const& blender_passes() {
    static std::array<exr_pass_names, 4> const passes{{
        {"UV pass", {"UV.U"}},
        {"UV pass", {"UV.V"}},
        {"Object Index pass", {"IndexOB.X", "IndexOB.V", "Object Index.X", "Object Index.V"}},
        {"Z pass", {"Depth.Z", "Depth.V", "Z.Z", "Z.V"}},
    }};
    return passes;
}

/// The channel of a layer under any spelling of a pass, or nullptr.
inline exr_channel const* find_pass(exr_file const& file, std::string const& layer, exr_pass_names const& pass) {
    for (auto const& name : pass.names) {
        if (auto const* const channel = file.find(layer.empty() ? name : layer + "." + name)) {
            return channel;
        }
    }
    return nullptr;
}

/// Layers that hold at least one of the passes, and how many of them.
inline std::map<std::string, std::size_t> blender_layers(exr_file const& file) {
    std::map<std::string, std::size_t> layers;
    for (auto const& channel : file.channels()) {
        std::string_view const name = channel.name;
        for (auto const& pass : blender_passes()) {
            for (auto const& ending : pass.names) {
                auto const has_layer = name.size() > ending.size() && name.ends_with(ending) &&
                                       name[name.size() - ending.size() - 1] == '.';
                if (has_layer || name == ending) {
                    ++layers[std::string(name.substr(0, has_layer ? name.size() - ending.size() - 1 : 0))];
                }
            }
        }
    }
    return layers;
}

/// Canonical positions: those of the rest pose, as a renderer's own output variable, or Blender's Position pass, which
/// is where points are in the world and so canonical only for what stands still.
inline std::vector<exr_channel> find_position(exr_file const& file, std::string const& layer, exr_layout layout) {
    using names = std::array<std::string, 3>;
    auto const prefix = layer.empty() ? layer : layer + ".";
    std::vector<names> const spellings =
        layout == exr_layout::plain
            ? std::vector<names>{{"x", "y", "z"}}
            : std::vector<names>{{prefix + "Rest.X", prefix + "Rest.Y", prefix + "Rest.Z"},
                                 {prefix + "Rest.R", prefix + "Rest.G", prefix + "Rest.B"},
                                 {prefix + "Position.X", prefix + "Position.Y", prefix + "Position.Z"}};
    for (auto const& spelling : spellings) {
        std::vector<exr_channel> channels;
        for (auto const& name : spelling) {
            if (auto const* const channel = file.find(name)) {
                channels.push_back(*channel);
            }
        }
        if (channels.size() == spelling.size()) {
            return channels;
        }
    }
    return {};
}

inline void require_float(exr_file const& file, exr_channel const& channel) {
    if (channel.type == Imf::UINT) {
        throw file_error(file.path().string() + ": channel " + channel.name +
                         " holds integers, expected 32-bit floats (quantised coordinates cannot address a texture)");
    }
}

} // namespace detail

/// The channels of the maps in `file`. `layer` names the view layer; empty takes the first that has all the passes,
/// or the plain layout if no layer has any. Throws file_error that lists what the file has and names what is missing,
/// or if UV or depth are integers.
inline exr_map_channels find_map_channels(exr_file const& file, std::string const& layer = "") {
    auto const path = file.path().string();
    exr_map_channels found;

    // Choose the layer with most of the passes
    auto const layers = detail::blender_layers(file);
    auto const* const u = file.find("u");
    if (layers.empty() && (u != nullptr || file.find("v") != nullptr)) {
        found.layout = exr_layout::plain;
    } else if (layers.empty()) {
        throw file_error(path + ": has the channels " + file.channel_names() +
                         ", expected Blender's UV, Z and Object Index passes (LAYER.UV.U, LAYER.UV.V, LAYER.Depth.Z, "
                         "LAYER.IndexOB.X) or u, v, id, depth");
    } else {
        found.layer = layer;
        std::size_t most = 0;
        for (auto const& [name, count] : layers) {
            if (layer.empty() && count > most) {
                most = count;
                found.layer = name;
            }
        }
    }

    // Take its channels
    std::array<exr_channel*, 4> const wanted{&found.u, &found.v, &found.object, &found.depth};
    std::array<char const*, 4> const plain_names{"u", "v", "id", "depth"};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        auto const& pass = detail::blender_passes()[i];
        auto const is_plain = found.layout == exr_layout::plain;
        auto const* const channel = is_plain ? file.find(plain_names[i]) : detail::find_pass(file, found.layer, pass);
        if (channel == nullptr) {
            auto const name = is_plain              ? plain_names[i]
                              : found.layer.empty() ? pass.names.front()
                                                    : found.layer + "." + pass.names.front();
            throw file_error(path + ": has the channels " + file.channel_names() + ", expected " + name + " as well" +
                             (is_plain ? "" : " (the view layer's " + std::string(pass.what) + ")"));
        }
        *wanted[i] = *channel;
    }
    if (found.layout == exr_layout::blender) {
        if (auto const* const alpha = file.find(found.layer.empty() ? "UV.A" : found.layer + ".UV.A")) {
            found.alpha = *alpha;
        }
    }

    found.position = detail::find_position(file, found.layer, found.layout);
    for (auto const* const channel : {&found.u, &found.v, &found.depth}) {
        detail::require_float(file, *channel);
    }
    for (auto const& channel : found.position) {
        detail::require_float(file, channel);
    }
    return found;
}

} // namespace genrender::examples
