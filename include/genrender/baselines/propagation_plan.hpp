// SPDX-License-Identifier: MIT
// [GR sec. 4: TokenFlow*] Which tokens of the two nearest keyframes a frame takes over, as a sparse map.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/blend_plan.hpp>
#include <genrender/core/error.hpp>
#include <genrender/correspondence/reproject.hpp>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace genrender {

/// The keyframes before and after a frame, as positions in the list of keyframes.
struct nearest_keyframes {
    std::size_t nearer = 0;             ///< the frame itself if it is a keyframe; the earlier one of two as near
    std::optional<std::size_t> farther; ///< on the other side; none at the ends, nor for a keyframe
};

/// The keyframes nearest to frame i in time on both sides, among at least one keyframe in any order.
inline nearest_keyframes nearest_in_time(std::span<frame_index const> keyframes, frame_index i) {
    std::optional<std::size_t> before; // or at the frame itself
    std::optional<std::size_t> after;
    for (std::size_t k = 0; k < keyframes.size(); ++k) {
        if (keyframes[k] <= i) {
            before = !before || keyframes[k] > keyframes[*before] ? k : before;
        } else {
            after = !after || keyframes[k] < keyframes[*after] ? k : after;
        }
    }
    assert((before || after) && "nearest_in_time: there is no keyframe");
    if (!before) {
        return {*after, std::nullopt};
    }
    if (!after || keyframes[*before] == i) {
        return {*before, std::nullopt};
    }
    auto const is_before_nearer = i.value - keyframes[*before].value <= keyframes[*after].value - i.value;
    return is_before_nearer ? nearest_keyframes{*before, after} : nearest_keyframes{*after, before};
}

/// Share of the keyframe `nearer` in frame i, which lies between it and `farther`, linear in time: |farther - i| /
/// |farther - nearer|, in [1/2, 1).
template <class Real>
constexpr Real share_of_nearer(frame_index nearer, frame_index i, frame_index farther) {
    auto const distance = [](frame_index a, frame_index b) {
        return static_cast<Real>(std::max(a, b).value - std::min(a, b).value);
    };
    return distance(farther, i) / distance(farther, nearer);
}

/// A plan that covers every token of one frame, and how many of them found a match by geometry.
template <class Real>
struct propagation_plan {
    blend_plan<Real> plan;   ///< the tokens that each token takes its output from, and their weights
    std::size_t matched = 0; ///< tokens that show an object whose point some neighbouring keyframe shows too
};

/// The match of a token of frame i in a keyframe by "nearest neighbour matching" with the true correspondence: the
/// token that shows the same surface point; for a token of the background, whose motion nobody tells, the token at the
/// same place on the screen if it too shows background. None where the keyframe shows something else.
template <correspondence_map Map>
std::optional<token_index> matching_token(Map const& map, frame_index keyframe, frame_index i, token_index token) {
    if (map.point_at(i, token)) {
        return corresponding_token(map, keyframe, i, token);
    }
    return map.point_at(keyframe, token) ? std::nullopt : std::optional(token);
}

/// Compiles the plan of frame i: every token is the sum of its matches in the keyframes before and after, with shares
/// linear in time. A match in one of them alone has all the weight; without a match, and since every token must come
/// from somewhere when attention is skipped, the token at the same place on the screen of the keyframe nearer in time
/// (of two as near, the earlier) is taken. A keyframe takes its own tokens. Throws value_error if a frame does not
/// exist or no keyframe is given.
template <class Real, correspondence_map Map>
propagation_plan<Real> make_propagation_plan(Map const& map, std::span<frame_index const> keyframes, frame_index i) {
    require_frame("make_propagation_plan", "i", map, i);
    require_value(!keyframes.empty(), "make_propagation_plan", "keyframes", "empty", "at least one keyframe");
    for (auto const keyframe : keyframes) {
        require_frame("make_propagation_plan", "keyframes", map, keyframe);
    }
    auto const nearest = nearest_in_time(keyframes, i);
    auto const nearer = keyframes[nearest.nearer];
    auto const share = nearest.farther ? share_of_nearer<Real>(nearer, i, keyframes[*nearest.farther]) : Real{1};

    auto const tokens = static_cast<std::uint32_t>(grid_extents(map.grid()).size());
    propagation_plan<Real> propagation;
    auto& plan = propagation.plan;
    plan.offsets.reserve(tokens + 1);
    auto const add = [&](std::size_t k, token_index token, Real weight) {
        plan.sources.push_back(static_cast<std::uint32_t>(k * tokens + token.value));
        plan.weights.push_back(weight);
    };
    for (std::uint32_t t = 0; t < tokens; ++t) {
        auto const match = nearer == i ? std::optional(token_index{t}) : matching_token(map, nearer, i, {t});
        auto const farther_match =
            nearest.farther ? matching_token(map, keyframes[*nearest.farther], i, {t}) : std::nullopt;
        if (match && farther_match) {
            add(nearest.nearer, *match, share);
            add(*nearest.farther, *farther_match, 1 - share);
        } else if (farther_match) {
            add(*nearest.farther, *farther_match, 1);
        } else {
            add(nearest.nearer, match.value_or(token_index{t}), 1);
        }
        if ((match || farther_match) && map.point_at(i, {t})) {
            ++propagation.matched;
        }
        plan.offsets.push_back(static_cast<std::uint32_t>(plan.sources.size()));
    }
    return propagation;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
