// SPDX-License-Identifier: MIT
// [GR eq. 5] Pre-attention injection: a frame attends to its own features and to the keyframes'.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/core/error.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

namespace detail {

/// Throws shape_error if features that tell their extents are of another number of frames.
template <class Features>
void require_frames(char const* function, char const* argument, Features const& x, std::size_t frames) {
    if constexpr (shaped_features<Features>) {
        std::array<std::size_t, 3> const extents = x.extents();
        require_extents(function, argument, extents, std::array{frames, extents[1], extents[2]});
    }
}

} // namespace detail

/// What frame `own` of K and V attends to: K^i = W^K [f^i, f_KF] and V^i = W^V [f^i, f_KF], its own tokens first and
/// then those of the `keyframes` frames of K_KF and V_KF in their order, none of them joined in memory. `left_out`
/// drops one keyframe, for readings in which a frame that is itself a keyframe does not meet itself twice. The result
/// points to its arguments. Throws shape_error if K_KF or V_KF tell their `extents()` and are of another number of
/// frames.
template <class Features>
std::vector<key_value_block<Features>>
pre_attention_sources(Features const& K, Features const& V, std::size_t own, Features const& K_KF, Features const& V_KF,
                      std::size_t keyframes, std::optional<std::size_t> left_out = std::nullopt) {
    detail::require_frames("pre_attention_sources", "K_KF", K_KF, keyframes);
    detail::require_frames("pre_attention_sources", "V_KF", V_KF, keyframes);
    std::vector<key_value_block<Features>> sources{{&K, &V, own}};
    for (std::size_t k = 0; k < keyframes; ++k) {
        if (k != left_out) {
            sources.push_back({&K_KF, &V_KF, k});
        }
    }
    return sources;
}

/// What all frames of K and V attend to, each as pre_attention_sources has it; frame i drops the keyframe left_out[i], an
/// entry for each frame of the stack. Throws as pre_attention_sources does.
template <class Features>
attention_sources<Features> injected_attention_sources(Features const& K, Features const& V, Features const& K_KF,
                                                       Features const& V_KF, std::size_t keyframes,
                                                       std::vector<std::optional<std::size_t>> left_out) {
    detail::require_frames("pre_attention_sources", "K_KF", K_KF, keyframes);
    detail::require_frames("pre_attention_sources", "V_KF", V_KF, keyframes);
    return attention_sources<Features>::own_and_joined(K, V, K_KF, V_KF, keyframes, std::move(left_out));
}

} // namespace genrender

#include <genrender/core/end_header.inl>
