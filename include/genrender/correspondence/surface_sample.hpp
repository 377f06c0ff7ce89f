// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Which point of the full-resolution UV maps stands for a token of a feature map.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/correspondence/texture_resolution.hpp>
#include <genrender/guidance/cell_extents.hpp>
#include <genrender/guidance/uv_maps_view.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// What one pixel of the UV maps shows.
struct surface_sample {
    object_index object;
    std::array<float, 2> uv;
    pixel at;
};

/// The sample that stands for a token: of the object that owns most pixels of the token's cell (ties by lowest number),
/// the pixel nearest to the cell's centre (ties by lowest row, then column). None where the background owns more pixels
/// than all objects together. Never an average of UVs, which would name a surface point that nobody sees.
inline std::optional<surface_sample> representative_sample(uv_maps_view const& maps, frame_index frame,
                                                           grid_extents grid, token_index token) {
    auto const cell = cell_extents("representative_sample", maps.grid(), grid);
    auto const top = static_cast<std::uint32_t>(token.value / grid.width * cell.height);
    auto const left = static_cast<std::uint32_t>(token.value % grid.width * cell.width);
    auto const for_each_covered_pixel = [&](auto&& visit) {
        for (auto row = top; row < top + cell.height; ++row) {
            for (auto column = left; column < left + cell.width; ++column) {
                if (maps.is_covered(frame, {row, column})) {
                    visit(pixel{row, column});
                }
            }
        }
    };

    // Count pixels per object; a cell seldom shows more than two.
    std::vector<std::pair<object_index, std::size_t>> owned;
    std::size_t covered = 0;
    for_each_covered_pixel([&](pixel p) {
        auto const object = maps.object_at(frame, p);
        auto const known =
            std::find_if(owned.begin(), owned.end(), [&](auto const& entry) { return entry.first == object; });
        if (known == owned.end()) {
            owned.emplace_back(object, 1);
        } else {
            ++known->second;
        }
        ++covered;
    });
    if (2 * covered < cell.size() || covered == 0) {
        return std::nullopt;
    }
    auto const owner = std::min_element(owned.begin(), owned.end(), [](auto const& a, auto const& b) {
        return a.second != b.second ? a.second > b.second : a.first < b.first;
    });

    // Take its pixel nearest to the centre, in units of half a pixel so that all is whole numbers.
    std::optional<surface_sample> nearest;
    std::int64_t nearest_distance = 0;
    for_each_covered_pixel([&](pixel p) {
        if (maps.object_at(frame, p) != owner->first) {
            return;
        }
        auto const down = 2 * std::int64_t{p.row - top} + 1 - static_cast<std::int64_t>(cell.height);
        auto const right = 2 * std::int64_t{p.column - left} + 1 - static_cast<std::int64_t>(cell.width);
        auto const distance = down * down + right * right;
        if (!nearest || distance < nearest_distance) {
            nearest = surface_sample{owner->first, maps.uv_at(frame, p), p};
            nearest_distance = distance;
        }
    });
    return nearest;
}

/// The texel of the object's T x T texture that holds (u, v): column floor(u T), row floor(v T); coordinates outside
/// [0, 1) go to the nearest texel. Throws value_error where u or v is not finite.
inline texel texel_of(surface_sample const& sample, texture_resolution const& resolution) {
    auto const T = static_cast<double>(resolution.of(sample.object));
    auto const clamped = [T](float coordinate) {
        require_value(std::isfinite(coordinate), "texel_of", "uv", coordinate, "finite texture coordinates");
        return static_cast<std::uint32_t>(std::clamp(std::floor(static_cast<double>(coordinate) * T), 0.0, T - 1));
    };
    return {sample.object, clamped(sample.uv[1]), clamped(sample.uv[0])};
}

} // namespace genrender
