// SPDX-License-Identifier: MIT
// Where UV, object, depth and rest position lie in the files of a frame: Blender's render passes of one or several view
// layers, its compositor's File Output node, or four plainly named channels.
#pragma once

#include "exr_cryptomatte.hpp"
#include "exr_frame.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// How the channels of a file are named.
enum class exr_layout {
    blender, ///< `LAYER.UV.U`, `LAYER.UV.V`, `LAYER.UV.A`, `LAYER.Depth.Z`, `LAYER.IndexOB.X` of a multilayer file, or
             ///< `UV.X`, `UV.Y`, `UV.Z`, `Depth.V`, `IndexOB.V` of the compositor
    plain    ///< `u`, `v`, `id`, `depth`
};

/// The channels of one layer of a frame that hold the maps.
struct exr_map_channels {
    exr_layout layout = exr_layout::blender;
    std::string layer; ///< what stands before `.UV.U`; empty in the plain layout
    exr_channel u;
    exr_channel v;
    std::optional<exr_channel> object;    ///< none: `cryptomatte` says
    std::vector<exr_channel> cryptomatte; ///< ids and coverages in turn; empty if there is an `object`
    exr_channel depth;
    std::optional<exr_channel> alpha;  ///< 0 where no surface was hit
    bool is_alpha_certain = true;      ///< not where it may be a third coordinate that nobody filled
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
        {"UV pass", {"UV.U", "UV.X", "UV.R"}},
        {"UV pass", {"UV.V", "UV.Y", "UV.G"}},
        {"Object Index pass",
         {"IndexOB.X", "IndexOB.V", "IndexOB.R", "Object Index.X", "Object Index.V", "Object Index.R", "ObjectIndex.V",
          "Index.X", "Index.V", "Index.R", "ID.V", "ID.R"}},
        {"Z pass", {"Depth.Z", "Depth.V", "Depth.R", "Z.Z", "Z.V", "Z.R"}},
    }};
    return passes;
}

/// The channel of a layer under any spelling of a pass, or nullptr.
inline exr_channel const* find_pass(exr_frame const& frame, std::string const& layer, exr_pass_names const& pass) {
    for (auto const& name : pass.names) {
        if (auto const* const channel = frame.find(layer.empty() ? name : layer + "." + name)) {
            return channel;
        }
    }
    return nullptr;
}

/// Layers that hold at least one of the passes, and how many of them; a Cryptomatte counts as the index pass.
inline std::map<std::string, std::size_t> blender_layers(exr_frame const& frame) {
    std::map<std::string, std::size_t> layers;
    for (auto const& channel : frame.channels()) {
        auto const name = lower_case(channel.name);
        for (auto const& pass : blender_passes()) {
            for (auto const& spelling : pass.names) {
                auto const ending = lower_case(spelling);
                auto const has_layer = name.size() > ending.size() && name.ends_with(ending) &&
                                       name[name.size() - ending.size() - 1] == '.';
                if (has_layer || name == ending) {
                    layers[channel.name.substr(0, has_layer ? name.size() - ending.size() - 1 : 0)] = 0;
                }
            }
        }
    }
    for (auto& [layer, count] : layers) {
        for (auto const& pass : blender_passes()) {
            count += find_pass(frame, layer, pass) != nullptr ? 1U : 0U;
        }
        auto const has_index = find_pass(frame, layer, blender_passes()[2]) != nullptr;
        count += !has_index && !find_cryptomatte(frame, layer).empty() ? 1U : 0U;
    }
    return layers;
}

/// Canonical positions: those of the rest pose, as a renderer's own output variable, or Blender's Position pass, which
/// is where points are in the world and so canonical only for what stands still.
inline std::vector<exr_channel> find_position(exr_frame const& frame, std::string const& layer, exr_layout layout) {
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
            if (auto const* const channel = frame.find(name)) {
                channels.push_back(*channel);
            }
        }
        if (channels.size() == spelling.size()) {
            return channels;
        }
    }
    return {};
}

inline void require_float(exr_frame const& frame, exr_channel const& channel) {
    if (channel.type == Imf::UINT) {
        throw file_error(frame.path().string() + ": channel " + channel.name +
                         " holds integers, expected 32-bit floats (quantised coordinates cannot address a texture)");
    }
}

/// The maps' channels of a layer, in the plain layout if `layer` is nothing.
inline exr_map_channels channels_of_layer(exr_frame const& frame, std::optional<std::string> const& layer) {
    exr_map_channels found;
    found.layout = layer ? exr_layout::blender : exr_layout::plain;
    found.layer = layer.value_or("");
    auto const prefix = found.layer.empty() ? found.layer : found.layer + ".";

    std::array<exr_channel const*, 4> channels{};
    std::array<char const*, 4> const plain_names{"u", "v", "id", "depth"};
    for (std::size_t i = 0; i < channels.size(); ++i) {
        auto const& pass = blender_passes()[i];
        channels[i] = layer ? find_pass(frame, found.layer, pass) : frame.find(plain_names[i]);
        if (i == 2 && layer && channels[i] == nullptr) {
            found.cryptomatte = find_cryptomatte(frame, found.layer);
        }
        if (channels[i] == nullptr && (i != 2 || found.cryptomatte.empty())) {
            throw file_error(frame.path().string() + ": has the channels " + frame.channel_names() + ", expected " +
                             (layer ? prefix + pass.names.front() : plain_names[i]) + " as well" +
                             (layer ? " (the view layer's " + std::string(pass.what) + ")" : ""));
        }
    }
    found.u = *channels[0];
    found.v = *channels[1];
    found.depth = *channels[3];
    if (channels[2] != nullptr) {
        found.object = *channels[2];
    }
    if (layer) {
        auto const* const alpha = frame.find(prefix + "UV.A");
        auto const is_of_colours = lower_case(found.u.name).ends_with(".r"); // whose alpha is the picture's
        auto const* const third = frame.find(prefix + (is_of_colours ? "UV.B" : "UV.Z")); // the compositor's
        found.is_alpha_certain = alpha != nullptr && !is_of_colours;
        if (found.is_alpha_certain || third != nullptr) {
            found.alpha = found.is_alpha_certain ? *alpha : *third;
        }
    }
    found.position = find_position(frame, found.layer, found.layout);
    for (auto const* const channel : {&found.u, &found.v, &found.depth}) {
        require_float(frame, *channel);
    }
    for (auto const& channel : found.position) {
        require_float(frame, channel);
    }
    return found;
}

} // namespace detail

/// The channels of the maps in a frame's files, of each view layer that has all the passes, or of `layer` alone if it is
/// not empty, or of the plain layout if no layer has any pass. Throws file_error that lists what the files have and
/// names what is missing, or if UV or depth are integers.
inline std::vector<exr_map_channels> find_map_channels(exr_frame const& frame, std::string const& layer = "") {
    auto const path = frame.path().string();
    auto const layers = detail::blender_layers(frame);
    if (layers.empty() && (frame.find("u") != nullptr || frame.find("v") != nullptr)) {
        return {detail::channels_of_layer(frame, std::nullopt)};
    }
    if (layers.empty()) {
        throw file_error(path + ": has the channels " + frame.channel_names() +
                         ", expected Blender's UV, Z and Object Index passes (LAYER.UV.U, LAYER.UV.V, LAYER.Depth.Z, "
                         "LAYER.IndexOB.X) or u, v, id, depth");
    }
    if (!layer.empty()) {
        if (layers.count(layer) == 0) {
            std::string names;
            for (auto const& [name, count] : layers) {
                names += (names.empty() ? "" : ", ") + (name.empty() ? "(without a name)" : name);
            }
            throw file_error(path + ": has passes of the view layers " + names + ", expected those of " + layer);
        }
        return {detail::channels_of_layer(frame, layer)};
    }
    std::vector<exr_map_channels> found;
    auto most = layers.begin();
    for (auto at = layers.begin(); at != layers.end(); ++at) {
        most = at->second > most->second ? at : most;
        if (at->second == detail::blender_passes().size()) {
            found.push_back(detail::channels_of_layer(frame, at->first));
        }
    }
    if (found.empty()) {
        return {detail::channels_of_layer(frame, most->first)};
    }
    return found;
}

/// The view layers of a frame that lack a pass, and so show nothing beside those that have all.
inline std::vector<std::string> incomplete_layers(exr_frame const& frame) {
    std::vector<std::string> names;
    for (auto const& [name, count] : detail::blender_layers(frame)) {
        if (count < detail::blender_passes().size() && !name.empty()) {
            names.push_back(name);
        }
    }
    return names;
}

} // namespace genrender::examples
