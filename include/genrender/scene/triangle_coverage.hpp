// SPDX-License-Identifier: MIT
// Which points a triangle covers as seen through a pinhole (Olano & Greer, Graphics Hardware 1997).
#pragma once

#include <genrender/core/begin_header.inl>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

namespace genrender {

/// A triangle in camera space, ready to say which points (x, y) of the plane z = -1 see it. Works in homogeneous
/// coordinates: a triangle may reach behind the camera without being cut, and the weights are perspective-correct as
/// they come.
///
/// Two triangles that share an edge and lie on its two sides never both cover a point and never leave one between them:
/// the edge's line is computed once, in an order that both agree on, and a point exactly on it belongs to the triangle
/// whose top or left edge it is.
class triangle_coverage {
public:
    /// Nothing if the triangle has no area to the eye: degenerate, or its plane goes through the eye.
    static std::optional<triangle_coverage> of(std::array<glm::dvec3, 3> const& corners) {
        auto const volume = glm::dot(corners[0], glm::cross(corners[1], corners[2]));
        auto const size = glm::length(corners[0]) * glm::length(corners[1]) * glm::length(corners[2]);
        if (!(std::abs(volume) > 8 * std::numeric_limits<double>::epsilon() * size)) {
            return std::nullopt;
        }
        triangle_coverage coverage;
        for (std::size_t i = 0; i < 3; ++i) {
            auto const line = edge_line(corners[(i + 1) % 3], corners[(i + 2) % 3]);
            coverage.lines_[i] = volume > 0 ? line : -line;
            coverage.owns_[i] = coverage.lines_[i].x > 0 || (coverage.lines_[i].x == 0 && coverage.lines_[i].y < 0);
        }
        return coverage;
    }

    /// The barycentric weights (sum 1, each in [0, 1]) of the triangle's point that is seen through (x, y); nothing if
    /// the triangle is not seen there, in front of the eye.
    std::optional<glm::dvec3> at(glm::dvec2 p) const {
        double e[3];
        auto const* const lines = lines_.data();
        for (int i = 0; i < 3; ++i) {
            e[i] = lines[i].x * p.x + lines[i].y * p.y - lines[i].z;
            if (e[i] < 0 || (e[i] == 0 && !owns_[static_cast<std::size_t>(i)])) {
                return std::nullopt;
            }
        }
        auto const sum = e[0] + e[1] + e[2];
        if (!(sum > 0)) {
            return std::nullopt;
        }
        return glm::dvec3(e[0] / sum, e[1] / sum, e[2] / sum);
    }

private:
    /// The plane through the eye and an edge, the same for both directions of the edge but for an exact change of sign.
    static glm::dvec3 edge_line(glm::dvec3 const& from, glm::dvec3 const& to) {
        auto const in_order = std::tie(from.x, from.y, from.z) < std::tie(to.x, to.y, to.z);
        auto const line = in_order ? glm::cross(from, to) : glm::cross(to, from);
        return in_order ? line : -line;
    }

    std::array<glm::dvec3, 3> lines_{}; ///< line i is opposite corner i; positive inside
    std::array<bool, 3> owns_{};        ///< whether points exactly on line i belong to this triangle
};

} // namespace genrender

#include <genrender/core/end_header.inl>
