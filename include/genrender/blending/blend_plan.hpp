// SPDX-License-Identifier: MIT
// [GR sec. 3.2, alg. 1: blend(pi_UV^-1(F_KF))] The unified texture seen by one frame, as a sparse map of keyframe
// tokens.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/quality_weights.hpp>
#include <genrender/blending/texel_weights.hpp>
#include <genrender/core/sparse_rows.hpp>
#include <genrender/correspondence/reproject.hpp>
#include <genrender/correspondence/token_matches.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
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
    std::vector<Real> weights;             ///< one per source; those of a token sum to 1

    /// The plan as it is applied: a row per token.
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

/// A correspondence_map that answers for all tokens of a frame at once, an optional capability: others are asked token
/// by token.
///
/// expression              | type                                    | meaning
/// ------------------------|-----------------------------------------|------------------------------------------------
/// `map.matches(from, to)` | vector<shared_ptr<token_matches const>> | for each frame of the span `to`, what
///                         |                                         | `token_at(to[k], *point_at(from, t))` and
///                         |                                         | quality_at are for every token t; empty where
///                         |                                         | there is more to say than that
template <class Map>
concept matched_correspondence_map = correspondence_map<Map> &&
    requires(Map const& map, frame_index i, std::span<frame_index const> to) {
    { map.matches(i, to) } -> std::same_as<std::vector<std::shared_ptr<token_matches const>>>;
};

namespace detail {

/// The plan from matches in each keyframe.
template <class Real>
blend_plan<Real> plan_of_matches(std::span<std::shared_ptr<token_matches const> const> matches, Real first_fill_share,
                                 texel_average average) {
    auto const keyframes = matches.size();
    auto const tokens = matches[0]->tokens.size();
    // The average's weights of keyframes that are alike, by how many see a point.
    std::vector<Real> alike(keyframes + 1);
    for (std::size_t seen = 1; seen <= keyframes; ++seen) {
        alike[seen] = average_weight<Real>(seen);
    }
    std::vector<std::uint32_t const*> token;
    std::vector<std::uint8_t const*> is_shown;
    std::vector<float const*> quality;
    for (auto const& match : matches) {
        token.push_back(match->tokens.data());
        is_shown.push_back(match->is_shown.data());
        quality.push_back(match->qualities.data());
    }
    blend_plan<Real> plan;
    plan.offsets.assign(tokens + 1, 0);
    // Entries are written before it is known whether they count, so there is room for one more.
    plan.sources.resize(tokens * keyframes + 1);
    plan.weights.resize(tokens * keyframes + 1);
    std::size_t entries = 0;
    for (std::size_t t = 0; t < tokens; ++t) {
        std::size_t seen = 0;
        double sum = 0;
        for (std::size_t k = 0; k < keyframes; ++k) {
            seen += is_shown[k][t];
            sum += double{quality[k][t]};
        }
        auto const is_graded = average == texel_average::by_quality && sum > 0;
        auto const share_of_one = is_graded ? 1 / sum : 0;
        auto const first = entries;
        for (std::size_t k = 0; k < keyframes && seen > 0; ++k) {
            auto const share = is_graded ? static_cast<Real>(double{quality[k][t]} * share_of_one) : alike[seen];
            plan.sources[entries] = static_cast<std::uint32_t>(k * tokens) + token[k][t];
            plan.weights[entries] = unified_weight<Real>(entries - first, share, first_fill_share);
            entries += is_shown[k][t];
        }
        plan.offsets[t + 1] = static_cast<std::uint32_t>(entries);
    }
    plan.sources.resize(entries);
    plan.weights.resize(entries);
    return plan;
}

/// The same with shares other than in proportion to quality, and with thresholds: the last of `matches` is that of the
/// frame with itself, where there is a threshold.
template <class Real>
blend_plan<Real> plan_of_weighed_matches(std::span<std::shared_ptr<token_matches const> const> matches,
                                         std::span<frame_index const> keyframes, Real first_fill_share,
                                         texel_average average, quality_weights const& weights) {
    auto const tokens = matches[0]->tokens.size();
    blend_plan<Real> plan;
    plan.offsets.reserve(tokens + 1);
    std::vector<double> shares;
    std::vector<frame_index> frames;
    std::vector<std::uint32_t> sources;
    for (std::size_t t = 0; t < tokens; ++t) {
        shares.clear();
        frames.clear();
        sources.clear();
        auto const own = matches.size() > keyframes.size() ? double{matches.back()->qualities[t]} : 0;
        for (std::size_t k = 0; k < keyframes.size(); ++k) {
            auto const quality = double{matches[k]->qualities[t]};
            if (matches[k]->is_shown[t] != 0 && is_good_match(quality, own, weights.threshold)) {
                shares.push_back(quality);
                frames.push_back(keyframes[k]);
                sources.push_back(static_cast<std::uint32_t>(k * tokens) + matches[k]->tokens[t]);
            }
        }
        average_shares(shares, frames, average, weights.exponent);
        for (std::size_t position = 0; position < shares.size(); ++position) {
            auto const share = static_cast<Real>(shares[position]);
            if (auto const weight = unified_weight<Real>(position, share, first_fill_share); weight > 0) {
                plan.sources.push_back(sources[position]);
                plan.weights.push_back(weight);
            }
        }
        plan.offsets.push_back(static_cast<std::uint32_t>(plan.sources.size()));
    }
    return plan;
}

} // namespace detail

/// Compiles the plan that gives frame i its F_bar = pi_i(T_bar), T_bar = unified texture of `keyframes` in their order:
/// a token whose surface point is seen by several keyframes mixes them by unified_weight, a token that no keyframe
/// covers has no entry. `weights` say what qualities do (quality_weights). Throws value_error if a frame does not exist, no keyframe is given or the share is outside [0,
/// 1].
template <class Real, correspondence_map Map>
blend_plan<Real> make_blend_plan(Map const& map, std::span<frame_index const> keyframes, frame_index i,
                                 std::type_identity_t<Real> first_fill_share = Real(0.5),
                                 texel_average average = texel_average::plain, quality_weights const& weights = {}) {
    require_frame("make_blend_plan", "i", map, i);
    require_value(!keyframes.empty(), "make_blend_plan", "keyframes", "empty", "at least one keyframe");
    for (auto const keyframe : keyframes) {
        require_frame("make_blend_plan", "keyframes", map, keyframe);
    }
    require_value(first_fill_share >= 0 && first_fill_share <= 1, "make_blend_plan", "first_fill_share",
                  first_fill_share, "a share in [0, 1]");

    if constexpr (matched_correspondence_map<Map>) {
        std::vector<frame_index> to(keyframes.begin(), keyframes.end());
        if (weights.threshold > 0) {
            to.push_back(i); // How well the frame itself shows what it shows.
        }
        auto const matches = map.matches(i, to);
        if (!matches.empty()) {
            return weights.are_plain() && average != texel_average::winner
                       ? detail::plan_of_matches<Real>(matches, first_fill_share, average)
                       : detail::plan_of_weighed_matches<Real>(matches, keyframes, first_fill_share, average, weights);
        }
    }

    auto const tokens = map.grid().size();
    blend_plan<Real> plan;
    plan.offsets.reserve(tokens + 1);
    struct source_token {
        std::size_t keyframe; // its position in `keyframes`, in the drawn order
        token_index token;
        double share; // of the keyframe, 1 unless several of its tokens show the point
    };
    std::vector<source_token> sources;
    std::vector<std::size_t> first_of; // the first source of each keyframe that sees the point
    std::vector<double> quality;
    std::vector<frame_index> seen_by;
    auto const asks_quality = average != texel_average::plain || weights.threshold > 0;
    for (std::uint32_t t = 0; t < tokens; ++t) {
        auto const point = map.point_at(i, {t});
        if (point) {
            sources.clear();
            first_of.clear();
            quality.clear();
            seen_by.clear();
            double quality_sum = 0;
            double own = 0;
            if constexpr (graded_correspondence_map<Map>) {
                own = weights.threshold > 0 ? map.quality_at(i, *point) : 0;
            }
            for (std::size_t k = 0; k < keyframes.size(); ++k) {
                auto const before = sources.size();
                if constexpr (weighted_correspondence_map<Map>) {
                    map.visit_tokens(keyframes[k], *point, [&](token_index token, double share) {
                        sources.push_back({k, token, share});
                    });
                } else if (auto const token = map.token_at(keyframes[k], *point)) {
                    sources.push_back({k, *token, 1});
                }
                double of_keyframe = 0;
                if constexpr (graded_correspondence_map<Map>) {
                    of_keyframe = asks_quality && sources.size() > before ? map.quality_at(keyframes[k], *point) : 0;
                }
                if (!is_good_match(of_keyframe, own, weights.threshold)) {
                    sources.resize(before);
                }
                if (sources.size() > before) {
                    first_of.push_back(before);
                    seen_by.push_back(keyframes[k]);
                    quality.push_back(average == texel_average::plain ? 0 : of_keyframe);
                    quality_sum += quality.back();
                }
            }
            auto const seen = first_of.size();
            first_of.push_back(sources.size());
            auto const are_shares = average == texel_average::winner || weights.exponent != 1;
            if (are_shares) {
                average_shares(quality, seen_by, average, weights.exponent);
            }
            for (std::size_t position = 0; position < seen; ++position) {
                auto const share = are_shares ? static_cast<Real>(quality[position])
                                              : average_weight_by_quality<Real>(quality[position], quality_sum, seen);
                auto const weight = unified_weight<Real>(position, share, first_fill_share);
                if (are_shares && !(weight > 0)) {
                    continue; // A keyframe without a share is no source.
                }
                for (auto s = first_of[position]; s < first_of[position + 1]; ++s) {
                    plan.sources.push_back(
                        static_cast<std::uint32_t>(sources[s].keyframe * tokens + sources[s].token.value));
                    plan.weights.push_back(weight * static_cast<Real>(sources[s].share));
                }
            }
        }
        plan.offsets.push_back(static_cast<std::uint32_t>(plan.sources.size()));
    }
    return plan;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
