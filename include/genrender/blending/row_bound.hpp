// SPDX-License-Identifier: MIT
// How many entries a row of a plan has at most, known before there is a plan.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/correspondence/chosen_correspondence.hpp>
#include <genrender/correspondence/correspondence_map.hpp>

#include <cstddef>
#include <optional>

namespace genrender {

/// W of plans of `keyframes` keyframes by the library's maps: `keyframes`, since footprints and the nearest samples of
/// texels show a point by one token a frame. None for texel_reading::average, where a texel has as many tokens as the
/// maps show in it: the compiled map tells.
inline std::optional<std::size_t> max_row_width(correspondence_settings const& settings, std::size_t keyframes) {
    auto const averages =
        settings.kind == correspondence_kind::texel_grid && settings.texels.reading == texel_reading::average;
    return averages ? std::nullopt : std::optional(keyframes);
}

/// W of plans of any `keyframes` frames by a map (make_blend_plan, make_propagation_plan): as many times the most tokens
/// that a frame shows a point by. That is 1 for a map that is no weighted_correspondence_map, what a
/// bounded_correspondence_map says, and all tokens of the grid for other weighted ones.
template <correspondence_map Map>
std::size_t max_row_width(Map const& map, std::size_t keyframes) {
    if constexpr (bounded_correspondence_map<Map>) {
        return keyframes * map.most_tokens();
    } else if constexpr (weighted_correspondence_map<Map>) {
        return keyframes * grid_extents(map.grid()).size();
    } else {
        return keyframes;
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
