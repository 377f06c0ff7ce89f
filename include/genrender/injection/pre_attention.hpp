// SPDX-License-Identifier: MIT
// [GR eq. 5] Pre-attention injection: a frame attends to its own features and to the keyframes'.
#pragma once

#include <genrender/attention/attention_call.hpp>

#include <cstddef>
#include <optional>
#include <vector>

namespace genrender {

/// What frame `own` of K and V attends to: K^i = W^K [f^i, f_KF] and V^i = W^V [f^i, f_KF], its own tokens first and
/// then those of the `keyframes` frames of K_KF and V_KF in their order, none of them joined in memory. `left_out`
/// drops one keyframe, for readings in which a frame that is itself a keyframe does not meet itself twice. The result
/// points to its arguments.
template <class Features>
std::vector<key_value_block<Features>>
pre_attention_sources(Features const& K, Features const& V, std::size_t own, Features const& K_KF, Features const& V_KF,
                      std::size_t keyframes, std::optional<std::size_t> left_out = std::nullopt) {
    std::vector<key_value_block<Features>> sources{{&K, &V, own}};
    for (std::size_t k = 0; k < keyframes; ++k) {
        if (k != left_out) {
            sources.push_back({&K_KF, &V_KF, k});
        }
    }
    return sources;
}

} // namespace genrender
