// SPDX-License-Identifier: MIT
// Linear blend skinning: vertices that follow the joints of a skeleton (Magnenat-Thalmann et al., 1988).
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>

#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace genrender {

/// How much of each of up to four joints a vertex follows; unused places have weight 0.
struct joint_weights {
    glm::uvec4 joints{0}; ///< positions in the skeleton
    glm::vec4 weights{0}; ///< shares, which sum to 1
};

/// Joints in an order in which parents come before their children.
struct skeleton {
    std::vector<std::optional<std::uint32_t>> parents; ///< nothing for a root
    std::vector<glm::mat4> rest;                       ///< each joint's space to its parent's, in the rest pose

    /// Number of joints.
    std::size_t joint_count() const { return parents.size(); }
};

/// Each joint's space to the skeleton's, from each joint's space to its parent's. Throws shape_error unless there is
/// one transform a joint, value_error at a joint that does not come after its parent.
inline std::vector<glm::mat4> global_transforms(skeleton const& bones, std::span<glm::mat4 const> local) {
    require_extents("global_transforms", "local", std::array{local.size()}, std::array{bones.joint_count()});
    std::vector<glm::mat4> global;
    global.reserve(local.size());
    for (std::size_t joint = 0; joint < local.size(); ++joint) {
        auto const parent = bones.parents[joint];
        if (parent && *parent >= joint) {
            auto const argument = "parents[" + std::to_string(joint) + "]";
            require_value(false, "global_transforms", argument.c_str(), *parent, "a joint before it");
        }
        global.push_back(parent ? global[*parent] * local[joint] : local[joint]);
    }
    return global;
}

/// What takes the rest pose back to each joint's own space: the inverse of the rest pose's global transforms. Throws as
/// they do.
inline std::vector<glm::mat4> inverse_bind(skeleton const& bones) {
    auto transforms = global_transforms(bones, bones.rest);
    for (auto& transform : transforms) {
        transform = glm::inverse(transform);
    }
    return transforms;
}

/// The weights of each vertex divided by their sum. Throws value_error at a weight that is negative or not finite, and
/// at a vertex whose weights sum to 0.
inline std::vector<joint_weights> normalized(std::vector<joint_weights> vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        auto& weights = vertices[i].weights;
        auto sum = 0.0f;
        for (int k = 0; k < 4; ++k) {
            if (!(weights[k] >= 0 && is_finite(weights[k]))) {
                auto const argument = "weights[" + std::to_string(i) + "]";
                require_value(false, "normalized", argument.c_str(), weights[k], "finite weights of at least 0");
            }
            sum += weights[k];
        }
        if (!(sum > 0)) {
            auto const argument = "sum of weights[" + std::to_string(i) + "]";
            require_value(false, "normalized", argument.c_str(), sum, "above 0");
        }
        weights /= sum;
    }
    return vertices;
}

/// Posed positions p' = sum_j w_j G_j B_j p, one for each of `rest`: B the inverse bind, G the joints' global
/// transforms in this pose. A vertex of one joint moves rigidly with it; in the rest pose nothing moves. Throws
/// shape_error unless there are weights for each vertex and as many transforms as inverse binds; value_error at a joint
/// that does not exist and at weights that do not sum to 1 within 0.001.
inline std::vector<glm::vec3> skin(std::span<glm::vec3 const> rest, std::span<joint_weights const> weights,
                                   std::span<glm::mat4 const> global, std::span<glm::mat4 const> bind) {
    require_extents("skin", "weights", std::array{weights.size()}, std::array{rest.size()});
    require_extents("skin", "bind", std::array{bind.size()}, std::array{global.size()});
    std::vector<glm::mat4> movement;
    movement.reserve(global.size());
    for (std::size_t joint = 0; joint < global.size(); ++joint) {
        movement.push_back(global[joint] * bind[joint]);
    }
    std::vector<glm::vec3> posed;
    posed.reserve(rest.size());
    for (std::size_t i = 0; i < rest.size(); ++i) {
        glm::mat4 blended{0};
        auto sum = 0.0f;
        for (int k = 0; k < 4; ++k) {
            auto const weight = weights[i].weights[k];
            auto const joint = weights[i].joints[k];
            if (joint >= movement.size()) {
                auto const argument = "weights[" + std::to_string(i) + "].joints";
                auto const expected = "joints below " + std::to_string(movement.size());
                require_value(false, "skin", argument.c_str(), joint, expected.c_str());
            }
            blended += weight * movement[joint];
            sum += weight;
        }
        if (!(std::abs(sum - 1) <= 1e-3f)) {
            auto const argument = "sum of weights[" + std::to_string(i) + "]";
            require_value(false, "skin", argument.c_str(), sum, "1");
        }
        posed.push_back(glm::vec3(blended * glm::vec4(rest[i], 1)));
    }
    return posed;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
