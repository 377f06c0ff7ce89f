// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] What a denoiser will be asked for in a run, told before its first call.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <cstddef>
#include <vector>

namespace genrender {

/// Every extent of a run that its settings and maps decide, so that graphs can be built and memory be had beforehand.
/// What is said of equations is what may be asked for at the places that take part; elsewhere attention is plain.
struct run_shapes {
    std::size_t frames = 0;    ///< of the animation
    std::size_t keyframes = 0; ///< m, the stack of every keyframe pass; the greatest if it varies; 0 if there is none
    std::size_t frames_per_call = 0;     ///< the stack of all other calls but the last of a pass
    std::size_t last_call = 0;           ///< the stack of the last call of a pass
    std::size_t calls_at_once = 0;       ///< at most so many calls run at the same time; 0 if the run's loop decides
    std::size_t row_width = 0;           ///< W: no row of a plan has more entries (max_row_width)
    std::vector<attention_place> places; ///< that take part, by site and then by branch
    bool attends_to_stack = true;        ///< eq. 3: keyframes attend to each other
    bool joins_keyframes = true;         ///< eq. 5: frames attend to their own tokens and those of keyframes
    bool leaves_out = true;              ///< eq. 5: some frames leave out one keyframe, which takes a mask
    bool mixes_rows = true;              ///< eq. 6: rows of F_KF are mixed in
    bool lists_sources = true;           ///< sources that are none of eqs. 1, 3 and 5 (attention_meaning::listed)
    bool scales_logits = false;          ///< logits of joined keys are multiplied (length_correction)
    bool counts_keys = false;            ///< keys of one surface point count together for one (point_counts)
    bool keeps_variance = false;         ///< eq. 6 keeps variance (mix_rows_keeping_variance)
    bool has_plain_steps = true;         ///< steps in which every frame is left to itself
    feature_storage storage = feature_storage::same; ///< how features of keyframes are kept
    /// Stacks of features of a place that are alive at a time beside those of the calls under way: 1 for the keyframes
    /// of a step. The bank of an evaluation has ended when the keyframe pass of the next begins, so that what an engine
    /// gave out (K, V, F, `stored`, record_features) may lie in memory that each keyframe pass uses again.
    std::size_t banks = 1;
};

/// A denoiser that is told the shapes of a run before its first call, an optional capability: others see them as they
/// come.
///
/// expression            | type | meaning
/// ----------------------|------|-------------------------------------------------------------------------------------
/// `phi.prepare(shapes)` | any  | called by `render` once, after the maps are compiled and before the first call, from
///                       |      | one thread; shapes are a run_shapes. May throw: a value_error with a sentence says
///                       |      | what this denoiser cannot do. const, as all of a denoiser's members are
///
/// A model owes that a call of the shapes it was told is not refused for its shape.
template <class Phi>
concept preparable_denoiser = denoiser<Phi> && requires(Phi const& phi, run_shapes const& shapes) {
    phi.prepare(shapes);
};

/// Tells a denoiser the shapes of a run where it wants to know. Throws what it throws.
template <denoiser Phi>
void prepare_denoiser(Phi const& phi, run_shapes const& shapes) {
    if constexpr (preparable_denoiser<Phi>) {
        phi.prepare(shapes);
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
