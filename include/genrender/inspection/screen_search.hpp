// SPDX-License-Identifier: MIT
// Where on the screen of a frame a surface point is seen, to a fraction of a pixel of the full-resolution maps.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/correspondence/nearest_samples.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/inspection/pixel_lattice.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// A place on the screen that shows a surface point.
template <std::size_t D>
struct screen_place {
    double row = 0;                 ///< in pixels; a pixel's middle lies at its row plus 0.5
    double column = 0;              ///< in pixels; a pixel's middle lies at its column plus 0.5
    pixel at;                       ///< the pixel that shows the point
    surface_footprint<D> footprint; ///< change of the point to the pixel on the right and the one below
    double offset = 0;              ///< from the pixel's middle along the axis on which it is further, in pixels
};

/// Finds surface points in one frame: from the nearest of a lattice of pixels it walks along the footprints to the
/// pixel whose own footprint holds the point. So the work and the memory of a search do not grow with the maps. Pixels
/// whose coordinates are not finite are not seen. The maps must outlive it.
template <canonical_maps Maps>
class screen_search {
public:
    /// Components of a coordinate.
    static constexpr auto dimensions = Maps::dimensions;
    using point_type = std::array<float, dimensions>; ///< a coordinate

    /// Remembers at most `most` pixels of frame i.
    screen_search(Maps const& maps, frame_index i, std::size_t most = std::size_t{1} << 16) : maps_(&maps), frame_(i) {
        std::map<object_index, std::vector<point_type>> points;
        pixel_lattice(maps.grid(), most).visit_pixels([&](pixel p) {
            if (maps.is_covered(i, p) && is_finite(maps.point_at(i, p))) {
                auto const object = maps.object_at(i, p);
                points[object].push_back(maps.point_at(i, p));
                of_object_[object].starts.push_back(p);
            }
        });
        for (auto& [object, places] : points) {
            of_object_[object].nearest = nearest_samples<dimensions>(std::move(places));
        }
    }

    /// Calls `visit(screen_place)` for places that show a point of an object; the same one possibly several times.
    template <class Visit>
    void visit_places(object_index object, point_type const& point, Visit&& visit) const {
        auto const known = of_object_.find(object);
        if (known == of_object_.end() || !is_finite(point)) {
            return;
        }
        known->second.nearest.visit_nearest(point, [&](std::size_t number) {
            if (auto const place = walk(known->second.starts[number], object, point)) {
                visit(*place);
            }
        });
    }

    /// Where a point is seen with the side on which `footprint` was seen: of all such places the one whose pixel's
    /// middle is nearest to the point.
    std::optional<screen_place<dimensions>> place_of(object_index object, point_type const& point,
                                                     surface_footprint<dimensions> const& footprint) const {
        std::optional<screen_place<dimensions>> best;
        visit_places(object, point, [&](screen_place<dimensions> const& place) {
            if (faces_alike(footprint, place.footprint) && (!best || place.offset < best->offset)) {
                best = place;
            }
        });
        return best;
    }

private:
    struct object_entry {
        std::vector<pixel> starts;
        nearest_samples<dimensions> nearest;
    };

    /// Steps to where the footprint at hand takes the point to be, until that is here.
    std::optional<screen_place<dimensions>> walk(pixel p, object_index object, point_type const& point) const {
        constexpr int most_steps = 6;
        for (int step = 0; step < most_steps; ++step) {
            auto const footprint = footprint_at(*maps_, frame_, p);
            if (!footprint) {
                return std::nullopt;
            }
            auto const offset = offset_on(*footprint, maps_->point_at(frame_, p), point);
            auto const distance = std::max(std::abs(offset.right), std::abs(offset.down));
            auto const row = p.row + 0.5 + offset.down;
            auto const column = p.column + 0.5 + offset.right;
            // Between pixels of a curved surface both send the point to each other: either may have it.
            if (distance <= (step + 1 < most_steps ? 0.5 : 0.75)) {
                auto const is_on_plane = offset.off_plane <= std::sqrt(footprint->area());
                return is_on_plane ? std::optional(screen_place<dimensions>{row, column, p, *footprint, distance})
                                   : std::nullopt;
            }
            auto const height = static_cast<double>(maps_->grid().height);
            auto const width = static_cast<double>(maps_->grid().width);
            // So written, not-a-number is outside too.
            if (!(row >= 0 && row < height && column >= 0 && column < width)) {
                return std::nullopt;
            }
            pixel const next{static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column)};
            if (!maps_->is_covered(frame_, next) || maps_->object_at(frame_, next) != object) {
                return std::nullopt;
            }
            p = next;
        }
        return std::nullopt;
    }

    Maps const* maps_;
    frame_index frame_;
    std::map<object_index, object_entry> of_object_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
