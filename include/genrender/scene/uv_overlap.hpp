// SPDX-License-Identifier: MIT
// How much of a mesh's texture is claimed by more than one place of its surface.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/scene/mesh.hpp>
#include <genrender/scene/triangle_coverage.hpp>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace genrender {

/// Texels of a square texture by how many triangles cover their centre.
struct uv_overlap {
    std::size_t covered = 0;     ///< by one triangle at least
    std::size_t overlapping = 0; ///< by more than one: two places of the surface would share their appearance
};

/// Counts over a texture of `resolution` x `resolution` texels. UVs outside [0, 1]^2 fall on no texel. Throws
/// value_error at a resolution of 0 and as validate(mesh) does.
inline uv_overlap count_uv_overlap(mesh const& surface, std::size_t resolution) {
    require_value(resolution > 0, "count_uv_overlap", "resolution", resolution, "at least 1");
    validate(surface, "count_uv_overlap");
    auto const T = static_cast<double>(resolution);
    auto const first_texel = [T](double lowest) { return std::clamp(std::floor(lowest - 0.5), 0.0, T); };
    auto const end_texel = [T](double highest) { return std::clamp(std::ceil(highest - 0.5) + 1, 0.0, T); };
    uv_overlap counts;
    std::vector<std::uint8_t> claims(resolution * resolution);
    for (auto const& t : surface.triangles) {
        std::array<glm::dvec3, 3> corners;
        for (int i = 0; i < 3; ++i) {
            corners[static_cast<std::size_t>(i)] = {glm::dvec2(surface.uvs[t[i]]) * T, -1};
        }
        auto const coverage = triangle_coverage::of(corners);
        if (!coverage) {
            continue;
        }
        auto const lower = glm::min(glm::min(corners[0], corners[1]), corners[2]);
        auto const upper = glm::max(glm::max(corners[0], corners[1]), corners[2]);
        auto const end_row = static_cast<std::size_t>(end_texel(upper.y));
        auto const end_column = static_cast<std::size_t>(end_texel(upper.x));
        for (auto row = static_cast<std::size_t>(first_texel(lower.y)); row < end_row; ++row) {
            auto* const claims_of_row = claims.data() + row * resolution;
            auto is_entered = false; // A row leaves a triangle once.
            for (auto column = static_cast<std::size_t>(first_texel(lower.x)); column < end_column; ++column) {
                if (coverage->at({static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5})) {
                    is_entered = true;
                    auto& claim = claims_of_row[column];
                    counts.covered += claim == 0;
                    counts.overlapping += claim == 1;
                    claim = static_cast<std::uint8_t>(std::min(claim + 1, 2));
                } else if (is_entered) {
                    break;
                }
            }
        }
    }
    return counts;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
