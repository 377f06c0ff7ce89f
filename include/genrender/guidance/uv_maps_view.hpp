// SPDX-License-Identifier: MIT
// [GR sec. 3] The view of UV maps through which every room downstream reads them, whoever owns the memory.
#pragma once

#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>

#include <array>
#include <cstdint>

namespace genrender {

/// UV maps of an animation in their owner's memory: full resolution, no antialiasing, floating point. A model of
/// canonical_maps.
class uv_maps_view {
public:
    static constexpr std::size_t dimensions = 2;

    /// `uv` [frames, height, width, 2] in texture coordinates, `object` and `coverage` [frames, height, width]. Throws
    /// shape_error if the extents do not fit each other.
    uv_maps_view(strided_view<float const, 4> uv, strided_view<std::uint32_t const, 3> object,
                 strided_view<std::uint8_t const, 3> coverage)
        : uv_(uv), object_(object), coverage_(coverage) {
        auto const& e = coverage.extents();
        require_shape("uv_maps_view", "uv", uv, {e[0], e[1], e[2], 2});
        require_shape("uv_maps_view", "object", object, e);
    }

    std::size_t frame_count() const { return coverage_.extent(0); }
    grid_extents grid() const { return {coverage_.extent(1), coverage_.extent(2)}; }

    /// Whether the pixel shows an object.
    bool is_covered(frame_index i, pixel p) const { return coverage_(i.value, p.row, p.column) != 0; }
    /// The object a covered pixel shows.
    object_index object_at(frame_index i, pixel p) const { return {object_(i.value, p.row, p.column)}; }
    /// (u, v) of a covered pixel.
    std::array<float, 2> uv_at(frame_index i, pixel p) const {
        return {uv_(i.value, p.row, p.column, 0), uv_(i.value, p.row, p.column, 1)};
    }
    /// The same as a canonical surface point.
    std::array<float, 2> point_at(frame_index i, pixel p) const { return uv_at(i, p); }

private:
    strided_view<float const, 4> uv_;
    strided_view<std::uint32_t const, 3> object_;
    strided_view<std::uint8_t const, 3> coverage_;
};

} // namespace genrender
