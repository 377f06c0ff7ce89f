// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Which point of the full-resolution UV maps stands for a token of a feature map.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/correspondence/representative_pixel.hpp>
#include <genrender/correspondence/texture_resolution.hpp>
#include <genrender/maps/uv_maps_view.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace genrender {

/// What one pixel of the UV maps shows.
struct surface_sample {
    object_index object;     ///< what the pixel shows
    std::array<float, 2> uv; ///< texture coordinates
    pixel at;                ///< of the maps
};

/// The sample under a token's representative_pixel; none where that is none. Never an average of UVs, which would name
/// a surface point that nobody sees.
inline std::optional<surface_sample> representative_sample(uv_maps_view const& maps, frame_index frame,
                                                           grid_extents grid, token_index token) {
    auto const p = representative_pixel(maps, frame, grid, token);
    return p ? std::optional(surface_sample{maps.object_at(frame, *p), maps.point_at(frame, *p), *p}) : std::nullopt;
}

/// The texel of the object's T x T texture that holds (u, v): column floor(u T), row floor(v T); coordinates outside
/// [0, 1) go to the nearest texel. Throws value_error where u or v is not finite.
inline texel texel_of(surface_sample const& sample, texture_resolution const& resolution) {
    auto const T = static_cast<double>(resolution.of(sample.object));
    auto const clamped = [T](float coordinate) {
        require_value(is_finite(coordinate), "texel_of", "uv", coordinate, "finite texture coordinates");
        return static_cast<std::uint32_t>(std::clamp(std::floor(static_cast<double>(coordinate) * T), 0.0, T - 1));
    };
    return {sample.object, clamped(sample.uv[1]), clamped(sample.uv[0])};
}

} // namespace genrender

#include <genrender/core/end_header.inl>
