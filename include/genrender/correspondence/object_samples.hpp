// SPDX-License-Identifier: MIT
// The pixels of a frame that stand for cells of a feature map, of one object, and which of them shows a point of it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/instance.hpp>
#include <genrender/correspondence/nearest_samples.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/correspondence/token_matches.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// A surface point and the footprint of the pixel that shows it.
template <std::size_t D>
struct footprint_point {
    object_index object;                           ///< whose surface it is
    std::array<float, D> place{};                  ///< canonical coordinates: UV, or a position at rest
    std::optional<surface_footprint<D>> footprint; ///< none for a pixel without neighbours of its object
};

/// Samples of one object in one frame. Of those nearest to a point in canonical space the one closest on the frame's
/// screen shows it, if it is within reach; ties by lowest token.
template <std::size_t D>
class object_samples {
public:
    using point_type = footprint_point<D>; ///< a surface point and how its pixel sees it

    /// What a pixel shows, and the token of the cell in which it lies.
    struct sample {
        std::array<float, D> place{}; ///< canonical coordinates: UV, or a position at rest
        /// How the pixel sees it; none for a pixel without neighbours of its object.
        std::optional<surface_footprint<D>> footprint;
        token_match match; ///< the token that the pixel speaks for
    };

    /// Of pixels in a frame whose cells have `cell` pixels. A sample reaches `reach` half cells.
    object_samples(std::vector<sample> samples, double reach, grid_extents cell);

    /// The sample that shows a point; null if none does.
    sample const* sample_of(point_type const& point) const;

    /// Bytes of so many samples, about.
    static constexpr std::size_t expected_bytes(std::size_t count) {
        return count * sizeof(sample) + nearest_samples<D>::expected_bytes(count);
    }

private:
    /// Where a point lies from a sample on the screen of its frame, in half cells along the axis on which it is
    /// further; none if it lies on a surface that faces the other way or not in the sample's plane.
    std::optional<double> screen_distance(sample const& s, point_type const& point) const {
        // Before all else: mirrored halves may have exactly the same places.
        if (s.footprint && point.footprint && !faces_alike(*s.footprint, *point.footprint)) {
            return std::nullopt;
        }
        if (s.place == point.place) {
            return 0;
        }
        // Around a sample without a footprint the screen is measured by that of the point.
        auto const& measure = s.footprint ? s.footprint : point.footprint;
        if (!measure) {
            return std::nullopt;
        }
        auto const offset = offset_on(*measure, s.place, point.place);
        if (D > 2 && offset.off_plane > 0.5 * std::sqrt(measure->area() * height_ * width_)) {
            return std::nullopt;
        }
        return std::max(std::abs(offset.down) / height_, std::abs(offset.right) / width_) * 2;
    }

    double reach_ = 0;
    double height_ = 1;
    double width_ = 1;
    std::vector<sample> samples_;
    nearest_samples<D> nearest_; ///< of the samples' places, by the same numbers
};

template <std::size_t D>
object_samples<D>::object_samples(std::vector<sample> samples, double reach, grid_extents cell)
    : reach_(reach), height_(static_cast<double>(cell.height)), width_(static_cast<double>(cell.width)),
      samples_(std::move(samples)) {
    samples_.shrink_to_fit();
    std::vector<std::array<float, D>> places;
    places.reserve(samples_.size());
    for (auto const& s : samples_) {
        places.push_back(s.place);
    }
    nearest_ = nearest_samples<D>(std::move(places));
}

template <std::size_t D>
auto object_samples<D>::sample_of(point_type const& point) const -> sample const* {
    sample const* closest = nullptr;
    double closest_distance = 0;
    nearest_.visit_nearest(point.place, [&](std::size_t number) {
        auto const& candidate = samples_[number];
        auto const distance = screen_distance(candidate, point);
        if (!distance || *distance > reach_) {
            return;
        }
        if (closest == nullptr ||
            std::pair(*distance, candidate.match.token) < std::pair(closest_distance, closest->match.token)) {
            closest = &candidate;
            closest_distance = *distance;
        }
    });
    return closest;
}

GENRENDER_CLASS_INSTANCE(object_samples<2>);
GENRENDER_CLASS_INSTANCE(object_samples<3>);

} // namespace genrender

#include <genrender/core/end_header.inl>
