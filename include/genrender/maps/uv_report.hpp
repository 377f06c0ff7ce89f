// SPDX-License-Identifier: MIT
// [GR sec. 3] What is unusual about given UV maps, in numbers, before they are worked with.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/core/index.hpp>
#include <genrender/maps/uv_maps_view.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace genrender {

/// Counts over all pixels of all frames.
struct uv_report {
    std::size_t pixels = 0;                ///< of all frames
    std::size_t covered = 0;               ///< of these, that show an object
    std::size_t out_of_range = 0;          ///< covered, finite, and u or v outside [0, 1]
    std::size_t not_finite = 0;            ///< covered, and u or v NaN or infinite
    std::vector<frame_index> empty_frames; ///< frames that show no object at all

    /// Share of the pixels that show no object, in [0, 1]; 0 for maps without pixels.
    double background_share() const {
        return pixels == 0 ? 0.0 : static_cast<double>(pixels - covered) / static_cast<double>(pixels);
    }
    /// Whether every covered pixel names a place on a texture.
    bool all_on_texture() const { return out_of_range == 0 && not_finite == 0; }
};

/// Counts what `maps` hold; uncovered pixels are not looked at.
inline uv_report inspect(uv_maps_view const& maps) {
    uv_report report;
    auto const grid = maps.grid();
    for (std::uint32_t frame = 0; frame < maps.frame_count(); ++frame) {
        auto const covered_before = report.covered;
        for (std::uint32_t row = 0; row < grid.height; ++row) {
            for (std::uint32_t column = 0; column < grid.width; ++column) {
                ++report.pixels;
                if (!maps.is_covered({frame}, {row, column})) {
                    continue;
                }
                ++report.covered;
                auto const uv = maps.point_at({frame}, {row, column});
                auto const finite = is_finite(uv[0]) && is_finite(uv[1]);
                auto const on_texture = uv[0] >= 0 && uv[0] <= 1 && uv[1] >= 0 && uv[1] <= 1;
                report.not_finite += !finite;
                report.out_of_range += finite && !on_texture;
            }
        }
        if (report.covered == covered_before) {
            report.empty_frames.push_back({frame});
        }
    }
    return report;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
