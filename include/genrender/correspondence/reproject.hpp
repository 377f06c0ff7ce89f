// SPDX-License-Identifier: MIT
// [GR eq. 4] Reprojection of features from one frame to another along the correspondences.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/correspondence/correspondence_map.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace genrender {

/// Throws value_error unless `frame` is one of the map's.
template <correspondence_map Map>
void require_frame(char const* function, char const* argument, Map const& map, frame_index frame) {
    require_value(frame.value < map.frame_count(), function, argument, frame.value,
                  ("a frame below " + std::to_string(map.frame_count())).c_str());
}

/// The token of frame `from` that shows what `token` of frame `to` shows; none where one of them does not see it.
template <correspondence_map Map>
std::optional<token_index> corresponding_token(Map const& map, frame_index from, frame_index to, token_index token) {
    auto const point = map.point_at(to, token);
    return point ? map.token_at(from, *point) : std::nullopt;
}

/// Writes F^j = pi_{i,j}(F^i): each token of frame j receives the feature of the token of frame i that shows the same
/// surface point; F_j, F_i [tokens, channels]. Returns which tokens were covered; the others of F_j are left as they
/// are. Throws shape_error or value_error if features or frames do not fit the map.
template <class Real, correspondence_map Map>
std::vector<std::uint8_t> reproject(strided_view<Real, 2> F_j, in_view<Real, 2> F_i, Map const& map, frame_index i,
                                    frame_index j) {
    require_frame("reproject", "i", map, i);
    require_frame("reproject", "j", map, j);
    auto const tokens = map.grid().size();
    require_shape("reproject", "F_j", F_j, {tokens, F_i.extent(1)});
    require_shape("reproject", "F_i", F_i, {tokens, F_i.extent(1)});
    std::vector<std::uint8_t> covered(tokens);
    for (std::size_t t = 0; t < tokens; ++t) {
        auto const source = corresponding_token(map, i, j, {static_cast<std::uint32_t>(t)});
        if (source) {
            copy(F_j[t], in_view<Real, 1>(F_i[source->value]));
            covered[t] = 1;
        }
    }
    return covered;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
