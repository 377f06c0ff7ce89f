// SPDX-License-Identifier: MIT
// [GR sec. 3.2, supplement: effect of texture resolution] How many texels along each side an object's texture has.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/maps/cell_extents.hpp>
#include <genrender/maps/uv_maps_view.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace genrender {

/// T of every object's square texture: one number for all, or matched to how densely the animation shows each object.
class texture_resolution {
public:
    static constexpr std::size_t greatest = std::size_t{1} << 20; ///< the greatest T

    /// T for every object. Throws value_error outside [1, 2^20].
    static texture_resolution same(std::size_t T) {
        require_value(T >= 1 && T <= greatest, "texture_resolution", "T", T, "1 to 1048576 texels");
        return texture_resolution(T);
    }

    /// T per object such that a token of `grid` spans about `texels_per_token` texels along each side:
    /// texels_per_token / T is the median UV step between neighbouring map pixels of the object, looked at once a cell
    /// of every frame, times the token's width in pixels. An object's chart borders do not disturb the median. Throws
    /// value_error if the grid does not divide the maps or texels_per_token is not above 0.
    static texture_resolution matched(uv_maps_view const& maps, grid_extents grid, double texels_per_token) {
        require_value(texels_per_token > 0, "texture_resolution", "texels_per_token", texels_per_token, "above 0");
        auto const cell = cell_extents("texture_resolution", maps.grid(), grid);
        std::map<object_index, std::vector<float>> steps;
        for (std::uint32_t frame = 0; frame < maps.frame_count(); ++frame) {
            // One pixel in each cell is enough for a median.
            for (auto row = static_cast<std::uint32_t>(cell.height / 2); row < maps.grid().height;
                 row += static_cast<std::uint32_t>(cell.height)) {
                for (auto column = static_cast<std::uint32_t>(cell.width / 2); column < maps.grid().width;
                     column += static_cast<std::uint32_t>(cell.width)) {
                    add_step(steps, maps, {frame}, {row, column}, {row, column + 1});
                    add_step(steps, maps, {frame}, {row, column}, {row + 1, column});
                }
            }
        }
        texture_resolution result(1);
        auto const width = std::sqrt(static_cast<double>(cell.size()));
        for (auto& [object, lengths] : steps) {
            auto const middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
            std::nth_element(lengths.begin(), middle, lengths.end());
            auto const footprint = std::max(static_cast<double>(*middle) * width, 1e-9);
            auto const T = std::round(texels_per_token / footprint);
            result.by_object_[object] = static_cast<std::size_t>(std::clamp(T, 1.0, static_cast<double>(greatest)));
        }
        return result;
    }

    /// T of an object; 1 for one that a matched resolution never saw.
    std::size_t of(object_index object) const {
        auto const found = by_object_.find(object);
        return found == by_object_.end() ? otherwise_ : found->second;
    }

private:
    explicit texture_resolution(std::size_t otherwise) : otherwise_(otherwise) {}

    /// Adds the UV distance of two neighbouring pixels if both show the same object.
    static void add_step(std::map<object_index, std::vector<float>>& steps, uv_maps_view const& maps, frame_index frame,
                         pixel a, pixel b) {
        if (b.row < maps.grid().height && b.column < maps.grid().width && maps.is_covered(frame, a) &&
            maps.is_covered(frame, b) && maps.object_at(frame, a) == maps.object_at(frame, b)) {
            auto const uv_a = maps.point_at(frame, a);
            auto const uv_b = maps.point_at(frame, b);
            auto const length = std::hypot(uv_a[0] - uv_b[0], uv_a[1] - uv_b[1]);
            // A median of numbers that do not compare is undefined; whoever reads such a UV refuses it.
            if (is_finite(length)) {
                steps[maps.object_at(frame, a)].push_back(length);
            }
        }
    }

    std::size_t otherwise_;
    std::map<object_index, std::size_t> by_object_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
