// SPDX-License-Identifier: MIT
// Simple surfaces whose UVs do not overlap: plane, disk, box, and surfaces of revolution (sphere, capsule, cylinder).
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/scene/mesh.hpp>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

namespace genrender {

namespace detail {

inline void require_above_zero(char const* function, char const* argument, float value) {
    require_value(value > 0 && is_finite(value), function, argument, value, "a finite length above 0");
}

/// Two triangles for each cell of a grid of (rows + 1) x (columns + 1) vertices that begins at vertex `first`.
inline void append_grid_triangles(mesh& surface, std::uint32_t first, std::uint32_t rows, std::uint32_t columns) {
    for (std::uint32_t row = 0; row < rows; ++row) {
        for (std::uint32_t column = 0; column < columns; ++column) {
            auto const corner = first + row * (columns + 1) + column;
            auto const below = corner + columns + 1;
            surface.triangles.push_back({corner, below, below + 1});
            surface.triangles.push_back({corner, below + 1, corner + 1});
        }
    }
}

} // namespace detail

/// A rectangle in the plane y = 0 around the origin, `size` = extents along x and z. u grows along +x, v along +z, so
/// the texture stands upright to an eye that looks along -z from above. Throws value_error at sizes not above 0 or no
/// segments.
inline mesh make_plane(glm::vec2 size, std::uint32_t segments = 1) {
    detail::require_above_zero("make_plane", "size.x", size.x);
    detail::require_above_zero("make_plane", "size.y", size.y);
    require_value(segments > 0, "make_plane", "segments", segments, "at least 1");
    mesh surface;
    for (std::uint32_t row = 0; row <= segments; ++row) {
        for (std::uint32_t column = 0; column <= segments; ++column) {
            auto const uv = glm::vec2(column, row) / static_cast<float>(segments);
            surface.positions.push_back({(uv.x - 0.5f) * size.x, 0, (uv.y - 0.5f) * size.y});
            surface.normals.push_back({0, 1, 0});
            surface.uvs.push_back(uv);
        }
    }
    detail::append_grid_triangles(surface, 0, segments, segments);
    return surface;
}

/// A disk in the plane y = 0 around the origin. Its UVs are the plane's: u along +x, v along +z, the rim touches the
/// borders of [0, 1]^2. Throws value_error at a radius not above 0 or fewer than 3 segments.
inline mesh make_disk(float radius, std::uint32_t segments = 64) {
    detail::require_above_zero("make_disk", "radius", radius);
    require_value(segments > 2, "make_disk", "segments", segments, "at least 3");
    mesh surface;
    surface.positions.push_back({0, 0, 0});
    surface.uvs.push_back({0.5f, 0.5f});
    for (std::uint32_t i = 0; i < segments; ++i) {
        auto const angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(segments);
        auto const rim = glm::vec2(std::cos(angle), std::sin(angle));
        surface.positions.push_back({rim.x * radius, 0, rim.y * radius});
        surface.uvs.push_back(rim * 0.5f + 0.5f);
        surface.triangles.push_back({0, (i + 1) % segments + 1, i + 1});
    }
    surface.normals.assign(surface.positions.size(), {0, 1, 0});
    return surface;
}

/// A box around the origin, `size` = its edges along x, y and z. Each face is a chart of its own in a 3 x 2 atlas with
/// a margin of 1/32 of a cell on each side: +x -x +y in the upper row, -y +z -z in the lower. Throws value_error at
/// sizes not above 0.
inline mesh make_box(glm::vec3 size) {
    mesh surface;
    for (int face = 0; face < 6; ++face) {
        auto const axis = face / 2;
        detail::require_above_zero("make_box", std::array{"size.x", "size.y", "size.z"}[static_cast<std::size_t>(axis)],
                                   size[axis]);
        glm::vec3 normal{0}, along_u{0}, along_v{0};
        normal[axis] = face % 2 == 0 ? 1.0f : -1.0f;
        // Sides have v downwards in space as in the texture; the lid and the floor have v along z as the plane has.
        along_v[axis == 1 ? 2 : 1] = axis == 1 ? 1.0f : -1.0f;
        along_u = glm::cross(normal, along_v);
        auto const cell = glm::vec2(1.0f / 3, 1.0f / 2);
        auto const cell_corner = glm::vec2(face % 3, face / 3) * cell;
        auto const first = static_cast<std::uint32_t>(surface.positions.size());
        for (int corner = 0; corner < 4; ++corner) {
            auto const place = glm::vec2(corner % 2, corner / 2);
            surface.positions.push_back((normal + along_u * (2 * place.x - 1) + along_v * (2 * place.y - 1)) * size *
                                        0.5f);
            surface.normals.push_back(normal);
            surface.uvs.push_back(cell_corner + cell * (1.0f / 32 + place * (30.0f / 32)));
        }
        detail::append_grid_triangles(surface, first, 1, 1);
    }
    return surface;
}

/// The surface that `profile` sweeps around the y axis. A profile point is (distance from the axis, y), from the top to
/// the bottom. u is the angle from +z towards +x over a whole turn, v the way along the profile over its length; the
/// seam is at +z. Where the profile touches the axis, triangles meet in a point with one vertex each. Throws
/// value_error at fewer than two profile points, two neighbours at one place, a negative distance, coordinates that are
/// not finite, or fewer than 3 segments.
inline mesh revolve(std::span<glm::vec2 const> profile, std::uint32_t segments) {
    require_value(profile.size() > 1, "revolve", "profile", profile.size(), "at least two points");
    require_value(segments > 2, "revolve", "segments", segments, "at least 3");
    detail::require_finite("revolve", "profile", profile);
    // The way from the top to each point, and the normal of the profile there as the mean of both sides'.
    std::vector<float> way{0};
    std::vector<glm::vec2> normal(profile.size(), glm::vec2(0));
    for (std::size_t i = 0; i < profile.size(); ++i) {
        require_value(profile[i].x >= 0, "revolve", "profile distance", profile[i].x, "at least 0");
        if (i > 0) {
            auto const step = profile[i] - profile[i - 1];
            require_value(glm::length(step) > 0, "revolve", "profile step", glm::length(step), "above 0");
            way.push_back(way.back() + glm::length(step));
            auto const outwards = glm::normalize(glm::vec2(-step.y, step.x));
            normal[i - 1] += outwards;
            normal[i] += outwards;
        }
    }
    mesh surface;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        // A point on the axis stands in the middle of its triangle's side of the chart.
        auto const shift = profile[i].x > 0 ? 0.0f : 0.5f;
        auto const side =
            profile[i].x > 0 && glm::length(normal[i]) > 0 ? glm::normalize(normal[i]) : glm::vec2(0, i == 0 ? 1 : -1);
        for (std::uint32_t k = 0; k <= segments; ++k) {
            // Whole turns end exactly where they began, so that the seam has no gap.
            auto const angle =
                2 * std::numbers::pi_v<float> * static_cast<float>(k % segments) / static_cast<float>(segments);
            auto const around = glm::vec2(std::sin(angle), std::cos(angle));
            surface.positions.push_back({profile[i].x * around.x, profile[i].y, profile[i].x * around.y});
            surface.normals.push_back({side.x * around.x, side.y, side.x * around.y});
            surface.uvs.push_back(
                {std::min((static_cast<float>(k) + shift) / static_cast<float>(segments), 1.0f), way[i] / way.back()});
        }
    }
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        for (std::uint32_t k = 0; k < segments; ++k) {
            auto const corner = static_cast<std::uint32_t>(i) * (segments + 1) + k;
            auto const below = corner + segments + 1;
            if (profile[i + 1].x > 0) {
                surface.triangles.push_back({corner, below, below + 1});
            }
            if (profile[i].x > 0) {
                surface.triangles.push_back({corner, profile[i + 1].x > 0 ? below + 1 : below, corner + 1});
            }
        }
    }
    return surface;
}

/// A sphere around the origin: revolve's UVs, so u = longitude from +z towards +x over a turn, v = angle from the +y
/// pole over pi. `segments` around, half as many from pole to pole. Throws value_error at a radius not above 0 or fewer
/// than 4 segments.
inline mesh make_sphere(float radius, std::uint32_t segments = 32) {
    detail::require_above_zero("make_sphere", "radius", radius);
    require_value(segments > 3, "make_sphere", "segments", segments, "at least 4");
    auto const rings = segments / 2;
    std::vector<glm::vec2> profile;
    for (std::uint32_t i = 0; i <= rings; ++i) {
        auto const angle = std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rings);
        profile.push_back({i % rings == 0 ? 0.0f : std::sin(angle) * radius, std::cos(angle) * radius});
    }
    return revolve(profile, segments);
}

/// A capsule around the origin along y, with half spheres beyond a side of length `length`: revolve's UVs. Throws
/// value_error at a radius or length not above 0 or fewer than 4 segments.
inline mesh make_capsule(float radius, float length, std::uint32_t segments = 32) {
    detail::require_above_zero("make_capsule", "radius", radius);
    detail::require_above_zero("make_capsule", "length", length);
    require_value(segments > 3, "make_capsule", "segments", segments, "at least 4");
    auto const rings = segments / 4;
    std::vector<glm::vec2> upper, lower;
    for (std::uint32_t i = 0; i <= rings; ++i) {
        auto const angle = std::numbers::pi_v<float> / 2 * static_cast<float>(i) / static_cast<float>(rings);
        auto const out = i == 0 ? 0.0f : std::sin(angle) * radius;
        upper.push_back({out, length / 2 + std::cos(angle) * radius});
        lower.push_back({out, -upper.back().y});
    }
    upper.insert(upper.end(), lower.rbegin(), lower.rend());
    return revolve(upper, segments);
}

/// A closed cylinder around the origin along y: revolve's UVs, lids included. Throws value_error at a radius or height
/// not above 0 or fewer than 3 segments.
inline mesh make_cylinder(float radius, float height, std::uint32_t segments = 32) {
    detail::require_above_zero("make_cylinder", "radius", radius);
    detail::require_above_zero("make_cylinder", "height", height);
    return revolve(
        std::array<glm::vec2, 4>{{{0, height / 2}, {radius, height / 2}, {radius, -height / 2}, {0, -height / 2}}},
        segments);
}

} // namespace genrender

#include <genrender/core/end_header.inl>
