// SPDX-License-Identifier: MIT
// [GR sec. 3] A triangle mesh with texture coordinates: the shape of one object, in its own space.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace genrender {

/// Vertices and the triangles between them. Each vertex has one (u, v); a texture seam is two vertices at one position.
/// Triangles are seen from both sides, so their winding carries no meaning for the guidance maps.
struct mesh {
    std::vector<glm::vec3> positions; ///< in the object's own space, scene units
    std::vector<glm::vec3> normals;   ///< unit length, one a vertex; empty if the mesh has none
    std::vector<glm::vec2> uvs; ///< (u, v), one a vertex; (0, 0) is the first texel's corner, [0, 1]^2 is the texture
    std::vector<glm::uvec3> triangles; ///< three vertex numbers each
};

namespace detail {

using genrender::is_finite;

inline bool is_finite(glm::vec2 p) { return is_finite(p.x) && is_finite(p.y); }

inline bool is_finite(glm::vec3 p) { return is_finite(p.x) && is_finite(p.y) && is_finite(p.z); }

/// Throws value_error `function: name[i] is not finite, expected finite coordinates` at the first such element.
template <class Vector>
void require_finite(char const* function, std::string const& name, std::span<Vector const> elements) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
        if (!is_finite(elements[i])) {
            auto const argument = name + "[" + std::to_string(i) + "]";
            require_value(false, function, argument.c_str(), "not finite", "finite coordinates");
        }
    }
}

} // namespace detail

/// Returns if the mesh can be drawn. Throws shape_error unless there is one UV a position, and one normal a position or
/// none; value_error at the first position, normal or UV that is not finite and the first triangle that names a vertex
/// that does not exist. `function` begins the text.
inline void validate(mesh const& surface, char const* function = "validate") {
    auto const vertices = surface.positions.size();
    require_extents(function, "mesh.uvs", std::array{surface.uvs.size()}, std::array{vertices});
    if (!surface.normals.empty()) {
        require_extents(function, "mesh.normals", std::array{surface.normals.size()}, std::array{vertices});
    }
    detail::require_finite(function, "mesh.positions", std::span(surface.positions));
    detail::require_finite(function, "mesh.normals", std::span(surface.normals));
    detail::require_finite(function, "mesh.uvs", std::span(surface.uvs));
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        auto const& t = surface.triangles[i];
        if (t.x >= vertices || t.y >= vertices || t.z >= vertices) {
            auto const argument = "mesh.triangles[" + std::to_string(i) + "]";
            auto const expected = "vertices below " + std::to_string(vertices);
            require_value(false, function, argument.c_str(), extents_text({t.x, t.y, t.z}), expected.c_str());
        }
    }
}

/// Appends a copy of `part`: one surface whose charts keep their UVs. Normals stay only if both meshes have them.
inline void append(mesh& whole, mesh const& part) {
    auto const keeps_normals =
        whole.normals.size() == whole.positions.size() && part.normals.size() == part.positions.size();
    auto const first = static_cast<glm::uint>(whole.positions.size());
    whole.positions.insert(whole.positions.end(), part.positions.begin(), part.positions.end());
    whole.uvs.insert(whole.uvs.end(), part.uvs.begin(), part.uvs.end());
    if (keeps_normals) {
        whole.normals.insert(whole.normals.end(), part.normals.begin(), part.normals.end());
    } else {
        whole.normals.clear();
    }
    whole.triangles.reserve(whole.triangles.size() + part.triangles.size());
    for (auto const& t : part.triangles) {
        whole.triangles.push_back(t + first);
    }
}

/// Moves UVs that fill [0, 1]^2 into the rectangle from `lower` to `upper`: a chart's place in an atlas.
inline void place_uvs(mesh& surface, glm::vec2 lower, glm::vec2 upper) {
    for (auto& uv : surface.uvs) {
        uv = lower + uv * (upper - lower);
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
