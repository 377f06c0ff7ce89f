// SPDX-License-Identifier: MIT
// The box, aligned to the axes, around a set of points.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <span>

namespace genrender {

/// All points p with lower <= p <= upper on each axis.
struct bounds {
    glm::vec3 lower{0}; ///< least of each coordinate
    glm::vec3 upper{0}; ///< greatest of each coordinate

    /// The middle of the box.
    glm::vec3 centre() const { return (lower + upper) * 0.5f; }
    /// Radius of the sphere around the box.
    float radius() const { return glm::length(upper - lower) * 0.5f; }
};

/// The smallest box around `positions`. Throws value_error if there are none.
inline bounds bounds_of(std::span<glm::vec3 const> positions) {
    require_value(!positions.empty(), "bounds_of", "positions", "empty", "at least one point");
    bounds box{positions[0], positions[0]};
    for (auto const& p : positions) {
        box = {glm::min(box.lower, p), glm::max(box.upper, p)};
    }
    return box;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
