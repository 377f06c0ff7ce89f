// SPDX-License-Identifier: MIT
// The pixels of a frame that speak for an object there, and which of them shows a point of it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/correspondence/sample_grid.hpp>
#include <genrender/correspondence/sample_tree.hpp>
#include <genrender/correspondence/surface_footprint.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// A surface point and the footprint of the pixel that shows it.
template <std::size_t D>
struct footprint_point {
    object_index object;
    std::array<float, D> place{};
    std::optional<surface_footprint<D>> footprint; ///< none for a pixel without neighbours of its object
};

/// Kept pixels of one object in one frame. Of those nearest to a point in canonical space the one closest on the
/// frame's screen shows it, if it is within reach; ties by lowest token.
template <std::size_t D>
class object_samples {
public:
    using point_type = footprint_point<D>;

    /// A token that shows a point.
    struct speaker {
        token_index token;
        float quality = 0; ///< how well: the share of the cell that is the object's, times pixels a unit of area
    };

    /// A pixel that speaks for its cell.
    struct sample : grid_sample<D> {
        speaker says;
    };

    /// Of pixels in a frame whose cells have `cell` pixels and keep samples `spacing` of them apart. A sample reaches
    /// `reach` half cells.
    object_samples(std::vector<sample> samples, double reach, grid_extents cell, double spacing)
        : reach_(reach), height_(static_cast<double>(cell.height)), width_(static_cast<double>(cell.width)),
          grid_(samples, reach, height_, width_, spacing) {
        shown_.assign(samples.begin(), samples.end());
        speakers_.reserve(samples.size());
        for (auto const& s : samples) {
            speakers_.push_back(s.says);
        }
    }

    /// The number of the sample that shows a point; none if none does.
    std::optional<std::uint32_t> number_at(point_type const& point) const {
        if (point.footprint) {
            using verdict = typename sample_grid<D>::verdict;
            auto const answer = grid_.find(point.place, *point.footprint);
            if (answer.is != verdict::unsure) {
                return answer.is == verdict::shown ? std::optional(answer.number) : std::nullopt;
            }
        }
        return number_by_tree(point);
    }

    /// The same in double precision, without the grid.
    std::optional<std::uint32_t> number_by_tree(point_type const& point) const {
        std::optional<std::uint32_t> closest;
        double closest_distance = 0;
        tree().visit_nearest(point.place, [&](std::size_t number) {
            auto const distance = screen_distance(shown_[number], point);
            if (!distance || *distance > reach_) {
                return;
            }
            if (!closest || std::pair(*distance, speakers_[number].token) <
                                std::pair(closest_distance, speakers_[*closest].token)) {
                closest = static_cast<std::uint32_t>(number);
                closest_distance = *distance;
            }
        });
        return closest;
    }

    /// Bytes of so many samples, about.
    static constexpr std::size_t expected_bytes(std::size_t count) {
        return count * (sizeof(grid_sample<D>) + sizeof(speaker)) + sample_bins<D>::expected_bytes(count) +
               sample_tree<D>::expected_bytes(count);
    }

    /// Who speaks for a sample.
    speaker const& speaker_of(std::uint32_t number) const { return speakers_[number]; }

private:
    /// Where a point lies from a kept pixel on the screen of its frame, in half cells along the axis on which it is
    /// further; none if it lies on a surface that faces the other way or not in the pixel's plane.
    std::optional<double> screen_distance(grid_sample<D> const& s, point_type const& point) const {
        // Before all else: mirrored halves may have exactly the same places.
        if (s.footprint && point.footprint && !faces_alike(*s.footprint, *point.footprint)) {
            return std::nullopt;
        }
        if (s.place == point.place) {
            return 0;
        }
        // A lonely pixel is measured by the footprint of the one who asks.
        auto const& measure = s.footprint ? s.footprint : point.footprint;
        if (!measure) {
            return std::nullopt;
        }
        auto const offset = offset_on(*measure, s.place, point.place);
        auto const limit = 0.5 * std::sqrt(measure->area() * height_ * width_);
        if (offset.off_plane > limit) {
            return std::nullopt;
        }
        return std::max(std::abs(offset.down) / height_, std::abs(offset.right) / width_) * 2;
    }

    /// Made for the first point that the grid is not sure of.
    sample_tree<D> const& tree() const {
        std::call_once(is_tree_made_, [this] {
            std::vector<std::array<float, D>> places;
            places.reserve(shown_.size());
            for (auto const& s : shown_) {
                places.push_back(s.place);
            }
            tree_ = sample_tree<D>(std::move(places));
        });
        return tree_;
    }

    double reach_ = 0;
    double height_ = 1;
    double width_ = 1;
    sample_grid<D> grid_;
    std::vector<grid_sample<D>> shown_; ///< by number, as the speakers
    std::vector<speaker> speakers_;
    mutable std::once_flag is_tree_made_;
    mutable sample_tree<D> tree_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
