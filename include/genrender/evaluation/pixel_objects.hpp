// SPDX-License-Identifier: MIT
// [GR sec. 4] Which pixels of an image an object fills, which the background, and which lie on a silhouette.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/maps/cell_extents.hpp>
#include <genrender/maps/uv_maps_view.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace genrender {

/// Says for an object whether a metric counts it, as `counts(object_index)`.
template <class Counts>
concept object_predicate = std::predicate<Counts const&, object_index>;

/// Counts all objects.
struct every_object {
    /// Always true.
    constexpr bool operator()(object_index) const { return true; }
};

/// What the pixels of an animation's images show, told from UV maps of the same or a finer resolution. A pixel belongs
/// to an object if the object fills all map pixels under it, and to the background if no object touches it. Pixels on a
/// silhouette belong to neither: their colour is a mixture, which says nothing of a surface.
class pixel_objects {
public:
    /// Throws value_error unless `grid`, height and width of the images, divides that of the maps.
    pixel_objects(uv_maps_view const& maps, grid_extents grid)
        : frames_(maps.frame_count()), grid_(grid), kinds_(frames_ * grid.size()), objects_(frames_ * grid.size()) {
        auto const cell = cell_extents("pixel_objects", maps.grid(), grid);
        for (std::uint32_t i = 0; i < frames_; ++i) {
            for (std::uint32_t row = 0; row < grid.height; ++row) {
                for (std::uint32_t column = 0; column < grid.width; ++column) {
                    classify(maps, {i}, {row, column}, cell);
                }
            }
        }
    }

    /// Number of frames.
    std::size_t frame_count() const { return frames_; }
    /// Height and width of a frame in pixels.
    grid_extents grid() const { return grid_; }

    /// The object that fills the pixel; none on the background and on silhouettes.
    std::optional<object_index> object_at(frame_index i, pixel p) const {
        auto const e = element(i, p);
        return kinds_[e] == kind::object ? std::optional(object_index{objects_[e]}) : std::nullopt;
    }

    /// Whether no object touches the pixel.
    bool is_background(frame_index i, pixel p) const { return kinds_[element(i, p)] == kind::background; }

private:
    enum class kind : std::uint8_t { background, object, silhouette };

    std::size_t element(frame_index i, pixel p) const {
        return i.value * grid_.size() + p.row * grid_.width + p.column;
    }

    void classify(uv_maps_view const& maps, frame_index i, pixel p, grid_extents cell) {
        std::size_t covered = 0;
        std::size_t owned = 0;
        object_index first;
        for (std::size_t e = 0; e < cell.size(); ++e) {
            pixel const at{static_cast<std::uint32_t>(p.row * cell.height + e / cell.width),
                           static_cast<std::uint32_t>(p.column * cell.width + e % cell.width)};
            if (maps.is_covered(i, at)) {
                auto const object = maps.object_at(i, at);
                first = covered++ == 0 ? object : first;
                owned += object == first ? 1U : 0U;
            }
        }
        kinds_[element(i, p)] = covered == 0           ? kind::background
                                : owned == cell.size() ? kind::object
                                                       : kind::silhouette;
        objects_[element(i, p)] = first.value;
    }

    std::size_t frames_;
    grid_extents grid_;
    std::vector<kind> kinds_;            // [frames, height, width]
    std::vector<std::uint32_t> objects_; // [frames, height, width], meaningful where kinds_ says object
};

/// Throws shape_error unless `images` [frames, channels, height, width] are those that `objects` speaks of.
template <class T>
void require_images_of(char const* function, strided_view<T, 4> const& images, pixel_objects const& objects) {
    require_shape(function, "images", images,
                  {objects.frame_count(), images.extent(1), objects.grid().height, objects.grid().width});
}

} // namespace genrender

#include <genrender/core/end_header.inl>
