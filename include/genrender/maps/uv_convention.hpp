// SPDX-License-Identifier: MIT
// [GR sec. 3] How another renderer writes UV, and the change to this library's way: v downwards, everything in [0, 1].
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/core/strided_view.hpp>

#include <cmath>
#include <cstdint>

namespace genrender {

/// What becomes of coordinates outside [0, 1].
enum class uv_outside {
    keep,  ///< they stay
    clamp, ///< the nearest border of the texture
    wrap   ///< the texture repeats; 0 and 1 themselves stay where they are
};

/// How maps were written.
struct uv_convention {
    bool v_upwards = false;                ///< v = 0 is the last row of texels (OpenGL, Blender) rather than the first
    uv_outside outside = uv_outside::keep; ///< what becomes of UVs outside [0, 1]
};

namespace detail {

inline float inside(float coordinate, uv_outside rule) {
    if (rule == uv_outside::keep || (coordinate >= 0 && coordinate <= 1) || !is_finite(coordinate)) {
        return coordinate;
    }
    if (rule == uv_outside::clamp) {
        return coordinate < 0 ? 0.0f : 1.0f;
    }
    // Just below a whole number the difference rounds up to 1, which is the right border of the texture.
    return coordinate - std::floor(coordinate);
}

} // namespace detail

/// Rewrites the covered pixels of `uv` [frames, height, width, 2] from `convention` to the library's: v first turned,
/// then both coordinates brought inside. Values that are not finite stay, for inspect to count. Throws shape_error
/// unless `coverage` is [frames, height, width].
inline void adopt_uv(strided_view<float, 4> uv, in_view<std::uint8_t, 3> coverage, uv_convention convention) {
    auto const& extents = coverage.extents();
    require_shape("adopt_uv", "uv", uv, {extents[0], extents[1], extents[2], 2});
    for (std::size_t frame = 0; frame < extents[0]; ++frame) {
        for (std::size_t row = 0; row < extents[1]; ++row) {
            for (std::size_t column = 0; column < extents[2]; ++column) {
                if (coverage(frame, row, column) == 0) {
                    continue;
                }
                auto& u = uv(frame, row, column, 0);
                auto& v = uv(frame, row, column, 1);
                u = detail::inside(u, convention.outside);
                v = detail::inside(convention.v_upwards ? 1 - v : v, convention.outside);
            }
        }
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
