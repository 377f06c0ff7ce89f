// SPDX-License-Identifier: MIT
// [GR sec. 3.2, alg. 1: blend(pi_UV^-1(F_KF))] The unified texture seen by one frame, as a sparse map of keyframe
// tokens.
#pragma once

#include <genrender/blending/texel_weights.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/correspondence/reproject.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace genrender {

/// For every token of one frame, the keyframe tokens that its blended feature F_bar sums, with weights that sum to 1.
/// Blending is linear and knows geometry alone, so one plan serves every layer of its resolution, every channel and
/// both guidance branches; the texture itself is never in memory.
template <class Real>
struct blend_plan {
    std::vector<std::uint32_t> offsets{0}; ///< tokens + 1 of them
    std::vector<std::uint32_t> sources;    ///< keyframe * tokens + token, keyframes counted in the drawn order
    std::vector<Real> weights;

    sparse_rows<Real> rows() const { return {offsets, sources, weights}; }

    /// Number of tokens that some keyframe covers.
    std::size_t covered_count() const {
        std::size_t count = 0;
        for (std::size_t t = 0; t + 1 < offsets.size(); ++t) {
            count += offsets[t] < offsets[t + 1] ? 1U : 0U;
        }
        return count;
    }
};

/// Compiles the plan that gives frame i its F_bar = pi_i(T_bar), T_bar = unified texture of `keyframes` in their order:
/// a token whose surface point is seen by several keyframes mixes them by unified_weight, a token that no keyframe
/// covers has no entry. Throws value_error if a frame does not exist, no keyframe is given or the share is outside [0,
/// 1].
template <class Real, correspondence_map Map>
blend_plan<Real> make_blend_plan(Map const& map, std::span<frame_index const> keyframes, frame_index i,
                                 std::type_identity_t<Real> first_fill_share = Real(0.5)) {
    require_frame("make_blend_plan", "i", map, i);
    require_value(!keyframes.empty(), "make_blend_plan", "keyframes", "empty", "at least one keyframe");
    for (auto const keyframe : keyframes) {
        require_frame("make_blend_plan", "keyframes", map, keyframe);
    }
    require_value(first_fill_share >= 0 && first_fill_share <= 1, "make_blend_plan", "first_fill_share",
                  first_fill_share, "a share in [0, 1]");

    auto const tokens = map.grid().size();
    blend_plan<Real> plan;
    plan.offsets.reserve(tokens + 1);
    std::vector<std::size_t> seeing; // positions in `keyframes`, in the drawn order
    std::vector<std::optional<token_index>> speakers(keyframes.size());
    for (std::uint32_t t = 0; t < tokens; ++t) {
        auto const point = map.point_at(i, {t});
        if (point) {
            seeing.clear();
            for (std::size_t k = 0; k < keyframes.size(); ++k) {
                speakers[k] = map.token_at(keyframes[k], *point);
                if (speakers[k]) {
                    seeing.push_back(k);
                }
            }
            for (std::size_t position = 0; position < seeing.size(); ++position) {
                auto const k = seeing[position];
                auto const weight = unified_weight<Real>(position, seeing.size(), first_fill_share);
                auto const add = [&](token_index token, double share) {
                    plan.sources.push_back(static_cast<std::uint32_t>(k * tokens + token.value));
                    plan.weights.push_back(weight * static_cast<Real>(share));
                };
                if constexpr (weighted_correspondence_map<Map>) {
                    map.visit_tokens(keyframes[k], *point, add);
                } else {
                    add(*speakers[k], 1);
                }
            }
        }
        plan.offsets.push_back(static_cast<std::uint32_t>(plan.sources.size()));
    }
    return plan;
}

} // namespace genrender
