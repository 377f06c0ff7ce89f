// SPDX-License-Identifier: MIT
// The skins of a glTF file: which nodes are their joints, and what takes the rest pose to each.
#pragma once

#include "gltf_accessor.hpp"
#include "gltf_document.hpp"

#include <tiny_gltf.h>

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace genrender::examples {

/// The joints of a mesh.
struct gltf_skin {
    std::vector<std::size_t> joints; ///< nodes
    std::vector<glm::mat4> bind;     ///< one a joint, and the identity for vertices that no joint holds
};

/// All skins of the document in their order; one without inverse binds has the identity. Throws file_error at joints
/// that are no nodes and at inverse binds that are not in the file or too few.
inline std::vector<gltf_skin> gltf_skins(gltf_document const& document, gltf_accessors& accessors) {
    std::vector<gltf_skin> skins;
    for (auto const& source : document.model.skins) {
        auto const what = "skin " + std::to_string(skins.size());
        auto& skin = skins.emplace_back();
        for (auto const joint : source.joints) {
            if (joint < 0 || static_cast<std::size_t>(joint) >= document.model.nodes.size()) {
                document.refuse(what + " has node " + std::to_string(joint) + " as a joint, expected one of " +
                                std::to_string(document.model.nodes.size()));
            }
            skin.joints.push_back(static_cast<std::size_t>(joint));
        }
        skin.bind.assign(skin.joints.size() + 1, glm::mat4(1));
        if (source.inverseBindMatrices < 0) {
            continue;
        }
        auto const matrices =
            accessors.floats(source.inverseBindMatrices, TINYGLTF_TYPE_MAT4, "the inverse binds of " + what);
        if (matrices.count < skin.joints.size()) {
            document.refuse(what + " has " + std::to_string(matrices.count) + " inverse binds, expected one for " +
                            "each of its " + std::to_string(skin.joints.size()) + " joints");
        }
        for (std::size_t i = 0; i < 16 * skin.joints.size(); ++i) {
            auto const within = static_cast<int>(i % 16);
            skin.bind[i / 16][within / 4][within % 4] = matrices.values[i];
        }
    }
    return skins;
}

} // namespace genrender::examples
