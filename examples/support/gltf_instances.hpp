// SPDX-License-Identifier: MIT
// The places of a glTF node's mesh: one, or those of EXT_mesh_gpu_instancing.
#pragma once

#include "gltf_accessor.hpp"
#include "gltf_document.hpp"
#include "gltf_nodes.hpp"

#include <tiny_gltf.h>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace genrender::examples {

/// Where the mesh of a node is drawn, in the node's space; once in its middle without the extension. Throws file_error
/// at numbers that are not in the file.
inline std::vector<glm::mat4> gltf_instances(gltf_document const& document, gltf_accessors& accessors,
                                             std::size_t node) {
    auto const& extensions = document.model.nodes[node].extensions;
    auto const found = extensions.find("EXT_mesh_gpu_instancing");
    if (found == extensions.end() || !found->second.Has("attributes")) {
        return {glm::mat4(1)};
    }
    auto const& attributes = found->second.Get("attributes");
    std::vector<gltf_transform> places;
    auto is_first = true;
    auto const each = [&](char const* name, int type, auto const& place) {
        if (!attributes.Has(name) || !attributes.Get(name).IsInt()) {
            return;
        }
        auto const what = std::string(name) + " of the instances of node " + std::to_string(node);
        auto const numbers = accessors.floats(attributes.Get(name).GetNumberAsInt(), type, what);
        if (!is_first && numbers.count != places.size()) {
            document.refuse(what + " is for " + std::to_string(numbers.count) + ", expected " +
                            std::to_string(places.size()));
        }
        is_first = false;
        places.resize(numbers.count);
        for (std::size_t i = 0; i < places.size(); ++i) {
            place(places[i], numbers.values.data() + i * numbers.width);
        }
    };
    each("TRANSLATION", TINYGLTF_TYPE_VEC3, [](auto& place, float const* v) {
        place.translation = {v[0], v[1], v[2]};
    });
    each("ROTATION", TINYGLTF_TYPE_VEC4,
         [](auto& place, float const* v) { place.rotation = glm::quat(v[3], v[0], v[1], v[2]); });
    each("SCALE", TINYGLTF_TYPE_VEC3, [](auto& place, float const* v) { place.scale = {v[0], v[1], v[2]}; });
    std::vector<glm::mat4> matrices;
    for (auto const& place : places) {
        matrices.push_back(place.matrix());
    }
    return is_first ? std::vector{glm::mat4(1)} : matrices;
}

} // namespace genrender::examples
