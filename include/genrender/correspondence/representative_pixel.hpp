// SPDX-License-Identifier: MIT
// [GR sec. 3.2] Which pixel of the full-resolution maps stands for a token of a feature map.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/maps/canonical_maps.hpp>
#include <genrender/maps/cell_extents.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// The pixel that stands for a token: of the object that owns most pixels of the token's cell (ties by lowest number),
/// the one nearest to the cell's centre (ties by lowest row, then column). None where the background owns more pixels
/// than all objects together. Throws value_error if the grid does not divide the maps.
template <canonical_maps Maps>
std::optional<pixel> representative_pixel(Maps const& maps, frame_index frame, grid_extents grid, token_index token) {
    auto const cell = cell_extents("representative_pixel", maps.grid(), grid);
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
    std::optional<pixel> nearest;
    std::int64_t nearest_distance = 0;
    for_each_covered_pixel([&](pixel p) {
        if (maps.object_at(frame, p) != owner->first) {
            return;
        }
        auto const down = 2 * std::int64_t{p.row - top} + 1 - static_cast<std::int64_t>(cell.height);
        auto const right = 2 * std::int64_t{p.column - left} + 1 - static_cast<std::int64_t>(cell.width);
        auto const distance = down * down + right * right;
        if (!nearest || distance < nearest_distance) {
            nearest = p;
            nearest_distance = distance;
        }
    });
    return nearest;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
