// SPDX-License-Identifier: MIT
// The animations of a glTF file: which node each channel moves, and how.
#pragma once

#include "gltf_accessor.hpp"
#include "gltf_document.hpp"
#include "gltf_track.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace genrender::examples {

/// What of a node is moved.
enum class gltf_property { translation, rotation, scale, weights };

/// One property of one node.
struct gltf_channel {
    std::size_t node = 0;
    gltf_property property = gltf_property::translation;
    std::shared_ptr<gltf_track const> track;
};

/// One animation.
struct gltf_animation {
    std::string name;
    std::vector<gltf_channel> channels;
};

namespace detail {

inline gltf_track gltf_track_of(gltf_document const& document, gltf_accessors& accessors,
                                tinygltf::AnimationSampler const& sampler, gltf_property property,
                                std::string const& what) {
    gltf_track track;
    track.is_rotation = property == gltf_property::rotation;
    if (sampler.interpolation == "STEP") {
        track.interpolation = gltf_interpolation::step;
    } else if (sampler.interpolation == "CUBICSPLINE") {
        track.interpolation = gltf_interpolation::cubic;
    } else if (sampler.interpolation != "LINEAR") {
        document.refuse(what + " is interpolated by " + sampler.interpolation +
                        ", expected LINEAR, STEP or CUBICSPLINE");
    }
    track.times = accessors.floats(sampler.input, TINYGLTF_TYPE_SCALAR, "the times of " + what).values;
    if (track.times.empty() ||
        !std::all_of(track.times.begin(), track.times.end(), [](float t) { return std::isfinite(t); }) ||
        !std::is_sorted(track.times.begin(), track.times.end())) {
        document.refuse(what + " has keys out of order, expected finite times that grow");
    }
    auto const type = property == gltf_property::weights    ? TINYGLTF_TYPE_SCALAR
                      : property == gltf_property::rotation ? TINYGLTF_TYPE_VEC4
                                                            : TINYGLTF_TYPE_VEC3;
    auto values = accessors.floats(sampler.output, type, "the values of " + what);
    auto const parts = track.times.size() * (track.interpolation == gltf_interpolation::cubic ? 3 : 1);
    // Weights are one number for each target, one after the other
    track.width = property == gltf_property::weights ? values.count / parts : values.width;
    if (track.width == 0 || values.values.size() != parts * track.width) {
        document.refuse(what + " has " + std::to_string(values.count) + " values for " +
                        std::to_string(track.times.size()) + " keys, expected as many for each");
    }
    track.values = std::move(values.values);
    return track;
}

} // namespace detail

/// All animations of the document in their order; channels that move something else than a node's transform or weights
/// are left out. Throws file_error at keys that are not in the file, or out of order, and at nodes that do not exist.
inline std::vector<gltf_animation> gltf_animations(gltf_document& document, gltf_accessors& accessors) {
    static constexpr std::array<std::string_view, 4> properties{"translation", "rotation", "scale", "weights"};
    std::vector<gltf_animation> animations;
    std::size_t left_out = 0;
    for (auto const& source : document.model.animations) {
        auto const number = std::to_string(animations.size());
        auto& animation = animations.emplace_back();
        animation.name = source.name.empty() ? "animation " + number : source.name;
        // A sampler may serve several channels
        std::vector<std::array<std::shared_ptr<gltf_track const>, 4>> tracks(source.samplers.size());
        for (auto const& channel : source.channels) {
            auto const property = std::find(properties.begin(), properties.end(), channel.target_path);
            if (channel.target_node < 0 || property == properties.end()) {
                ++left_out;
                continue;
            }
            auto const what = "the " + channel.target_path + " of node " + std::to_string(channel.target_node) +
                              " in animation " + number;
            if (static_cast<std::size_t>(channel.target_node) >= document.model.nodes.size()) {
                document.refuse(what + " is of no node of the file, expected one of " +
                                std::to_string(document.model.nodes.size()));
            }
            if (channel.sampler < 0 || static_cast<std::size_t>(channel.sampler) >= tracks.size()) {
                document.refuse(what + " follows sampler " + std::to_string(channel.sampler) + ", expected one of " +
                                std::to_string(tracks.size()));
            }
            auto const sampler = static_cast<std::size_t>(channel.sampler);
            auto const kind = static_cast<std::size_t>(property - properties.begin());
            auto& track = tracks[sampler][kind];
            if (track == nullptr) {
                track = std::make_shared<gltf_track const>(detail::gltf_track_of(
                    document, accessors, source.samplers[sampler], static_cast<gltf_property>(kind), what));
            }
            animation.channels.push_back(
                {static_cast<std::size_t>(channel.target_node), static_cast<gltf_property>(kind), track});
        }
    }
    if (left_out > 0) {
        document.notes.push_back(
            std::to_string(left_out) +
            " animation channels move something else than a node or its weights, and do not play.");
    }
    return animations;
}

} // namespace genrender::examples
