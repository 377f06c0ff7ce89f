// SPDX-License-Identifier: MIT
// [GR sec. 3] Maps without what no search can take: pixels whose canonical coordinates are not finite.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/core/index.hpp>
#include <genrender/maps/canonical_maps.hpp>

#include <array>
#include <cstddef>

namespace genrender {

/// A model of canonical_maps that shows what other maps show where it is finite, and background elsewhere. Those maps
/// must outlive it.
template <canonical_maps Maps>
class finite_maps {
public:
    /// Components of a coordinate.
    static constexpr std::size_t dimensions = Maps::dimensions;

    /// Views maps, which have to outlive this.
    explicit finite_maps(Maps const& maps) : maps_(&maps) {}

    /// Number of frames.
    std::size_t frame_count() const { return maps_->frame_count(); }
    /// Height and width of a frame in pixels.
    grid_extents grid() const { return maps_->grid(); }

    /// Whether the pixel shows an object at a place that is known.
    bool is_covered(frame_index i, pixel p) const {
        return maps_->is_covered(i, p) && is_finite(maps_->point_at(i, p));
    }
    /// The object a covered pixel shows.
    object_index object_at(frame_index i, pixel p) const { return maps_->object_at(i, p); }
    /// Canonical coordinates of a covered pixel.
    std::array<float, dimensions> point_at(frame_index i, pixel p) const { return maps_->point_at(i, p); }

private:
    Maps const* maps_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
