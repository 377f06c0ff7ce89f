// SPDX-License-Identifier: MIT
// [GR sec. 4: Ablation studies] What of the keyframes is injected into the other frames.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/kept_variance.hpp>

namespace genrender {

/// alpha of eq. 6 in the paper's experiments: the share of the blended features in F_out.
inline constexpr double paper_alpha = 0.7;

/// The switches of injection; each is an ablation of the paper.
struct injection_settings {
    bool pre_attention = true;  ///< eq. 5, and eq. 3 among keyframes; without it a frame attends to itself alone
    bool post_attention = true; ///< eq. 6; without it F_out = F_hat
    /// A frame that is itself a keyframe finds its tokens twice in [f^i, f_KF], as eq. 5 has it; false drops the second
    /// copy.
    bool keeps_own_copy = true;
    /// Power of ln(keys) / ln(own keys), by which logits are multiplied where a frame attends to other frames' keys too
    /// (length_correction): 0 leaves them as the paper has them, 1 is the whole correction, 1/2 its square root. The
    /// baselines read it as well.
    double length_correction = 0;
    /// Whether the keys of eqs. 3 and 5 that show one surface point count together for one (point_counts): -log of their
    /// number is added to their logits. Needs correspondences with pre-attention alone, too.
    bool counts_points = false;
    kept_variance variance{}; ///< the variance that eq. 6 keeps; the default is eq. 6 as the paper has it
};

} // namespace genrender

#include <genrender/core/end_header.inl>
