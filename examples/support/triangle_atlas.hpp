// SPDX-License-Identifier: MIT
// [GR sec. 3] Texture coordinates for a mesh that has none: every pair of triangles gets a square of its own.
#pragma once

#include <genrender/scene/mesh.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace genrender::examples {

/// A mesh whose triangles share no vertex, and where each vertex came from.
struct triangle_atlas {
    mesh surface;
    std::vector<std::uint32_t> source; ///< the vertex of the given mesh, one for each of `surface`
};

namespace detail {

/// The corners, one of each triangle, that do not lie on an edge both have; nothing if they have no edge in common.
inline std::optional<std::pair<int, int>> corners_off_common_edge(mesh const& surface, glm::uvec3 a, glm::uvec3 b) {
    auto const same = [&](int i, int j) { return surface.positions[a[i]] == surface.positions[b[j]]; };
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            auto const turned = same((i + 1) % 3, (j + 2) % 3) && same((i + 2) % 3, (j + 1) % 3);
            if (turned) {
                return std::pair{i, j};
            }
        }
    }
    return std::nullopt;
}

} // namespace detail

/// The same surface with UVs that cannot overlap: triangles 2k and 2k + 1 share one square of a grid over [0, 1]^2,
/// as two halves of a quadrilateral where they have an edge in common, else apart. A tenth of the square is left free
/// to its neighbours. The texture is torn at most edges and its density differs from triangle to triangle; UVs made
/// by hand are better. Triangles must name vertices that exist.
inline triangle_atlas make_triangle_atlas(mesh const& given) {
    auto const cells = (given.triangles.size() + 1) / 2;
    auto const side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(cells))));
    triangle_atlas atlas;
    auto const add = [&](glm::uvec3 const& triangle, int first_corner, std::size_t cell,
                         std::array<glm::vec2, 3> const& uvs) {
        glm::vec2 const origin(static_cast<float>(cell % side), static_cast<float>(cell / side));
        auto const first = static_cast<std::uint32_t>(atlas.source.size());
        for (int i = 0; i < 3; ++i) {
            auto const vertex = triangle[(first_corner + i) % 3];
            atlas.source.push_back(vertex);
            atlas.surface.positions.push_back(given.positions[vertex]);
            if (!given.normals.empty()) {
                atlas.surface.normals.push_back(given.normals[vertex]);
            }
            atlas.surface.uvs.push_back((origin + uvs[static_cast<std::size_t>(i)]) / static_cast<float>(side));
        }
        atlas.surface.triangles.push_back({first, first + 1, first + 2});
    };
    constexpr auto m = 0.05f; // margin
    constexpr auto gap = 3 * m;
    for (std::size_t i = 0; i < given.triangles.size(); i += 2) {
        auto const& a = given.triangles[i];
        auto const has_two = i + 1 < given.triangles.size();
        auto const& b = given.triangles[has_two ? i + 1 : i];
        if (auto const off = detail::corners_off_common_edge(given, a, b); has_two && off) {
            add(a, off->first, i / 2, {{{m, m}, {1 - m, m}, {m, 1 - m}}});
            add(b, off->second, i / 2, {{{1 - m, 1 - m}, {m, 1 - m}, {1 - m, m}}});
        } else {
            add(a, 0, i / 2, {{{m, m}, {1 - gap, m}, {m, 1 - gap}}});
            if (has_two) {
                add(b, 0, i / 2, {{{1 - m, 1 - m}, {gap, 1 - m}, {1 - m, gap}}});
            }
        }
    }
    return atlas;
}

} // namespace genrender::examples
