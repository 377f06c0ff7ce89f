// SPDX-License-Identifier: MIT
// The surfaces of a glTF file: triangles of lists, strips and fans, joints of any number of sets, morph targets.
#pragma once

#include "gltf_accessor.hpp"
#include "gltf_document.hpp"
#include "model_assembly.hpp"
#include "model_shape.hpp"

#include <genrender/scene/skinning.hpp>

#include <glm/vec3.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace genrender::examples {

namespace detail {

/// Of the vertices in the order in which they are drawn; `mode` is a primitive's.
inline std::vector<glm::uvec3> gltf_triangles(std::vector<std::uint32_t> const& order, int mode) {
    std::vector<glm::uvec3> triangles;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        for (std::size_t i = 0; i + 2 < order.size(); i += 3) {
            triangles.push_back({order[i], order[i + 1], order[i + 2]});
        }
    }
    for (std::size_t i = 2; i < order.size(); ++i) {
        glm::uvec3 triangle(order[i - 2], order[i - 1], order[i]);
        if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
            triangle.x = order[0];
        } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            triangle = i % 2 == 0 ? triangle : glm::uvec3(triangle.y, triangle.x, triangle.z);
        } else {
            break; // points and lines have no surface
        }
        // What joins two strips has two corners in one place
        if (triangle.x != triangle.y && triangle.y != triangle.z && triangle.z != triangle.x) {
            triangles.push_back(triangle);
        }
    }
    return triangles;
}

} // namespace detail

/// What one primitive of a mesh holds; without triangles if it is of points or lines. `joints` is the number of joints
/// of the skin it is drawn with, 0 without one. `what` names the primitive.
inline model_arrays gltf_arrays(gltf_document const& document, gltf_accessors& accessors,
                                tinygltf::Primitive const& primitive, std::size_t joints,
                                model_assembly const& assembly, std::string const& what) {
    model_arrays arrays;
    auto const attribute = [&](std::string const& name) {
        auto const found = primitive.attributes.find(name);
        return found == primitive.attributes.end() ? -1 : found->second;
    };
    if (attribute("POSITION") < 0 || primitive.mode < TINYGLTF_MODE_TRIANGLES) {
        return arrays;
    }
    auto const vectors = [&](int accessor, std::string const& name) {
        auto const numbers = accessors.floats(accessor, TINYGLTF_TYPE_VEC3, name + " of " + what);
        std::vector<glm::vec3> result;
        result.reserve(numbers.count);
        for (std::size_t i = 0; i < numbers.count; ++i) {
            result.push_back({numbers.values[3 * i], numbers.values[3 * i + 1], numbers.values[3 * i + 2]});
        }
        return result;
    };
    auto const require_each = [&](std::size_t count, std::string const& name) {
        if (count != arrays.surface.positions.size()) {
            document.refuse(name + " of " + what + " is for " + std::to_string(count) + " vertices, expected " +
                            std::to_string(arrays.surface.positions.size()));
        }
    };
    arrays.surface.positions = vectors(attribute("POSITION"), "POSITION");
    auto const vertices = arrays.surface.positions.size();

    // The triangles
    std::vector<std::uint32_t> order;
    if (primitive.indices >= 0) {
        order = accessors.integers(primitive.indices, TINYGLTF_TYPE_SCALAR, "indices of " + what).values;
    } else {
        for (std::size_t i = 0; i < vertices; ++i) {
            order.push_back(static_cast<std::uint32_t>(i));
        }
    }
    arrays.surface.triangles = detail::gltf_triangles(order, primitive.mode);

    // Texture coordinates: v is 0 at the top, as ours
    auto const uv_name = "TEXCOORD_" + std::to_string(assembly.uv_set);
    if (assembly.uvs == model_uvs::from_file && attribute(uv_name) >= 0) {
        auto const uvs = accessors.floats(attribute(uv_name), TINYGLTF_TYPE_VEC2, uv_name + " of " + what);
        require_each(uvs.count, uv_name);
        for (std::size_t i = 0; i < uvs.count; ++i) {
            arrays.surface.uvs.push_back({uvs.values[2 * i], uvs.values[2 * i + 1]});
        }
    }

    // Joints, of which a file may name four more with each set
    for (std::size_t set = 0; joints > 0; ++set) {
        auto const number = std::to_string(set);
        if (attribute("JOINTS_" + number) < 0 || attribute("WEIGHTS_" + number) < 0) {
            break;
        }
        auto const named =
            accessors.integers(attribute("JOINTS_" + number), TINYGLTF_TYPE_VEC4, "JOINTS_" + number + " of " + what);
        auto const weights =
            accessors.floats(attribute("WEIGHTS_" + number), TINYGLTF_TYPE_VEC4, "WEIGHTS_" + number + " of " + what);
        require_each(named.count, "JOINTS_" + number);
        require_each(weights.count, "WEIGHTS_" + number);
        arrays.joints = joints;
        arrays.weights.resize(vertices);
        for (std::size_t i = 0; i < 4 * vertices; ++i) {
            if (!std::isfinite(weights.values[i])) {
                document.refuse("WEIGHTS_" + number + " of " + what + " is not finite at vertex " +
                                std::to_string(i / 4) + ", expected shares");
            }
            if (weights.values[i] > 0 && named.values[i] >= joints) {
                document.refuse("JOINTS_" + number + " of " + what + " names joint " + std::to_string(named.values[i]) +
                                " at vertex " + std::to_string(i / 4) + ", expected joints below " +
                                std::to_string(joints));
            }
            if (weights.values[i] > 0) {
                add_weight(arrays.weights[i / 4], named.values[i], weights.values[i]);
            }
        }
    }

    // Morph targets
    for (auto const& target : primitive.targets) {
        auto const positions = target.find("POSITION");
        arrays.morph_offsets.push_back(positions == target.end() ? std::vector<glm::vec3>(vertices, glm::vec3(0))
                                                                 : vectors(positions->second, "a morph target"));
        require_each(arrays.morph_offsets.back().size(), "a morph target");
    }
    return arrays;
}

} // namespace genrender::examples
