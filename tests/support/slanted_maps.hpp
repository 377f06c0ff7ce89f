// SPDX-License-Identifier: MIT
// UV maps of one slanted surface before a background, without defects; what has one starts from them.
#pragma once

#include <genrender/maps/uv_maps.hpp>

#include <cstddef>

namespace genrender::testing {

/// Background pixels on each side of the surface.
inline constexpr std::size_t slanted_margin = 4;

/// Calls `visit(row, column)` for the pixels of the surface.
template <class Visit>
void visit_slanted(uv_maps const& maps, Visit&& visit) {
    for (auto row = slanted_margin; row + slanted_margin < maps.grid().height; ++row) {
        for (auto column = slanted_margin; column + slanted_margin < maps.grid().width; ++column) {
            visit(row, column);
        }
    }
}

/// Object 0 on 64 x 64 pixels, 4 of them background on each side: u and v change by about 0.0093 a pixel, and the whole
/// moves by 1.25 pixels to the left from frame to frame.
inline uv_maps slanted_maps(std::size_t frames) {
    uv_maps maps(frames, {64, 64});
    for (std::size_t i = 0; i < frames; ++i) {
        visit_slanted(maps, [&](std::size_t row, std::size_t column) {
            auto const x = static_cast<float>(column) + 1.25F * static_cast<float>(i);
            auto const y = static_cast<float>(row);
            maps.coverage(i, row, column) = 1;
            maps.uv(i, row, column, 0) = 0.1307F + 0.00913F * x + 0.00171F * y;
            maps.uv(i, row, column, 1) = 0.1911F - 0.00113F * x + 0.00931F * y;
        });
    }
    return maps;
}

/// The same surface with coordinates that `change(u, v, row, column)` rewrites.
template <class Change>
uv_maps changed_maps(std::size_t frames, Change&& change) {
    auto maps = slanted_maps(frames);
    for (std::size_t i = 0; i < frames; ++i) {
        visit_slanted(maps, [&](std::size_t row, std::size_t column) {
            change(maps.uv(i, row, column, 0), maps.uv(i, row, column, 1), row, column);
        });
    }
    return maps;
}

} // namespace genrender::testing
