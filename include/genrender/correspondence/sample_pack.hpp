// SPDX-License-Identifier: MIT
// Kept pixels of a frame side by side, with what measures the screen around them in single precision.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/correspondence/surface_footprint.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace genrender {

/// What a kept pixel shows.
template <std::size_t D>
struct grid_sample {
    std::array<float, D> place{};
    std::optional<surface_footprint<D>> footprint;
};

/// across x down: the surface's normal, as long as the footprint's area.
inline std::array<double, 3> normal_of(surface_footprint<3> const& footprint) {
    auto const& [a, b] = footprint;
    return {double{a[1]} * double{b[2]} - double{a[2]} * double{b[1]},
            double{a[2]} * double{b[0]} - double{a[0]} * double{b[2]},
            double{a[0]} * double{b[1]} - double{a[1]} * double{b[0]}};
}

/// Pixels side by side: their places; the ways right and down on the screen in half cells and, in space, the normal in
/// units of the greatest distance from the plane.
template <std::size_t D>
struct alignas(64) sample_pack {
    static constexpr std::size_t size = 16;
    /// Longer and thinner footprints have no measures: single precision would not do.
    static constexpr double worst_condition = 300;

    std::array<std::array<float, size>, D> places;
    std::array<std::array<float, size>, D*(D > 2 ? 3 : 2)> measures; ///< no numbers where there are none

    /// Fills one of the pixels, of a frame whose cells are `rows` x `columns` of the map's pixels.
    void set(std::size_t at, grid_sample<D> const& s, double rows, double columns) {
        using of = surface_footprint<D>;
        for (std::size_t d = 0; d < D; ++d) {
            places[d][at] = s.place[d];
        }
        for (auto& measure : measures) {
            measure[at] = std::numeric_limits<float>::quiet_NaN();
        }
        if (!s.footprint) {
            return;
        }
        // The dual vectors of across and down.
        auto const& [across, down] = *s.footprint;
        auto const aa = of::dot(across, across);
        auto const dd = of::dot(down, down);
        auto const ad = of::dot(across, down);
        auto const determinant = aa * dd - ad * ad;
        if (!(determinant > 0 && (aa + dd) * (aa + dd) < worst_condition * worst_condition * determinant)) {
            return;
        }
        for (std::size_t d = 0; d < D; ++d) {
            auto const right = (double{across[d]} * dd - double{down[d]} * ad) / determinant;
            auto const below = (double{down[d]} * aa - double{across[d]} * ad) / determinant;
            measures[d][at] = static_cast<float>(right * 2 / columns);
            measures[D + d][at] = static_cast<float>(below * 2 / rows);
        }
        if constexpr (D == 3) {
            auto const area = std::sqrt(determinant);
            auto const limit = 0.5 * std::sqrt(area * rows * columns);
            auto const normal = normal_of(*s.footprint);
            for (std::size_t d = 0; d < D; ++d) {
                measures[2 * D + d][at] = static_cast<float>(normal[d] / (area * limit));
            }
        }
    }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
