// SPDX-License-Identifier: MIT
// The pixels of a frame that speak for an object there, and which of them shows a point of it.
#pragma once

#include <genrender/core/index.hpp>
#include <genrender/correspondence/sample_grid.hpp>
#include <genrender/correspondence/sample_tree.hpp>
#include <genrender/correspondence/surface_footprint.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

/// Kept pixels of one object in one frame. Of those nearest to a point in canonical space the one closest on the frame's
/// screen shows it, if it is within reach; ties by lowest token.
template <std::size_t D>
class kept_samples {
public:
    using point_type = footprint_point<D>;

    /// A pixel that speaks for its cell.
    struct sample {
        token_index token;
        float purity = 0; ///< share of the cell's pixels that show the sample's object
        std::array<float, D> place{};
        std::optional<surface_footprint<D>> footprint;
        double density = 0; ///< pixels a unit of canonical area

        /// How well the frame shows what the sample shows: purity times density.
        double quality() const { return double{purity} * density; }
    };

    void add(sample const& s) { samples_.push_back(s); }

    /// Makes all that was added ready to be asked, in a frame whose cells have `cell` pixels and keep samples `spacing`
    /// of them apart. A sample reaches `reach` half cells.
    void compile(double reach, grid_extents cell, double spacing) {
        reach_ = reach;
        height_ = static_cast<double>(cell.height);
        width_ = static_cast<double>(cell.width);
        std::vector<std::array<float, D>> places;
        std::vector<grid_sample<D>> for_grid;
        for_grid.reserve(samples_.size());
        for (auto const& s : samples_) {
            places.push_back(s.place);
            for_grid.push_back({static_cast<std::uint32_t>(for_grid.size()), s.place, s.footprint});
        }
        tree_ = sample_tree<D>(std::move(places));
        grid_ = sample_grid<D>(for_grid, reach, height_, width_, spacing);
    }

    /// The sample that shows a point; null if none does.
    sample const* sample_at(point_type const& point) const {
        if (point.footprint) {
            using verdict = typename sample_grid<D>::verdict;
            auto const answer = grid_.find(point.place, *point.footprint);
            if (answer.is != verdict::unsure) {
                return answer.is == verdict::shown ? &samples_[answer.number] : nullptr;
            }
        }
        return sample_by_tree(point);
    }

    /// The same in double precision, without the grid.
    sample const* sample_by_tree(point_type const& point) const {
        sample const* closest = nullptr;
        double closest_distance = 0;
        tree_.visit_nearest(point.place, [&](std::size_t number) {
            auto const& s = samples_[number];
            auto const distance = screen_distance(s, point);
            if (!distance || *distance > reach_) {
                return;
            }
            if (closest == nullptr || std::pair(*distance, s.token) < std::pair(closest_distance, closest->token)) {
                closest = &s;
                closest_distance = *distance;
            }
        });
        return closest;
    }

private:
    /// Where a point lies from a kept pixel on the screen of its frame, in half cells along the axis on which it is
    /// further; none if it lies on a surface that faces the other way or not in the pixel's plane.
    std::optional<double> screen_distance(sample const& s, point_type const& point) const {
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

    std::vector<sample> samples_;
    sample_tree<D> tree_;
    sample_grid<D> grid_;
    double reach_ = 0;
    double height_ = 1;
    double width_ = 1;
};

} // namespace genrender
