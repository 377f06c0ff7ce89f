// SPDX-License-Identifier: MIT
// [GR alg. 1: pi_UV, pi_UV^-1] Features of a frame unprojected into a texture, and a texture projected to a frame.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/correspondence/reproject.hpp>
#include <genrender/correspondence/texel_grid.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace genrender {

/// Writes T = pi^-1(F): each texel that frame i sees receives the feature of the token that shows it; T [slots,
/// channels], F [tokens, channels]. Returns which slots were filled; the others of T are left as they are. Throws
/// shape_error or value_error if they do not fit the map. The library itself never builds a texture, see blend_plan.
template <class Real>
std::vector<std::uint8_t> unproject(strided_view<Real, 2> T, in_view<Real, 2> F, texel_grid const& map, frame_index i) {
    require_frame("unproject", "i", map, i);
    require_shape("unproject", "F", F, {map.grid().size(), F.extent(1)});
    require_shape("unproject", "T", T, {map.slot_count(), F.extent(1)});
    std::vector<std::uint8_t> filled(map.slot_count());
    for (std::uint32_t slot = 0; slot < map.slot_count(); ++slot) {
        map.visit_tokens(i, {slot}, [&](token_index token, double weight) {
            for (std::size_t c = 0; c < F.extent(1); ++c) {
                auto const part = static_cast<Real>(weight) * F(token.value, c);
                T(slot, c) = filled[slot] != 0 ? T(slot, c) + part : part;
            }
            filled[slot] = 1;
        });
    }
    return filled;
}

/// Writes F = pi(T): each token of frame i that shows an object receives the texel it reads; F [tokens, channels],
/// T [slots, channels]. Returns which tokens were covered; the others of F are left as they are. Throws as unproject
/// does.
template <class Real>
std::vector<std::uint8_t> project(strided_view<Real, 2> F, in_view<Real, 2> T, texel_grid const& map, frame_index i) {
    require_frame("project", "i", map, i);
    require_shape("project", "F", F, {map.grid().size(), T.extent(1)});
    require_shape("project", "T", T, {map.slot_count(), T.extent(1)});
    std::vector<std::uint8_t> covered(F.extent(0));
    for (std::size_t t = 0; t < F.extent(0); ++t) {
        auto const point = map.point_at(i, {static_cast<std::uint32_t>(t)});
        if (point) {
            copy(F[t], in_view<Real, 1>(T[point->slot]));
            covered[t] = 1;
        }
    }
    return covered;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
