// SPDX-License-Identifier: MIT
// [GR alg. 1] The second way in: what a static graph takes as extra inputs and gives as extra outputs at each site.
#pragma once

#include <genrender/attention/plain_attention.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/keyframes/recorder.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace genrender {

/// The extra inputs of one run of a static graph at one place. Every member is known before the graph starts, because
/// Alg. 1 finishes the keyframe pass before the injected pass begins.
template <class Features, class Real>
struct feature_inputs {
    bool attends_to_stack = false;           ///< eq. 3: keys and values of all frames of the stack
    Features const* f_KF = nullptr;          ///< eq. 5: tokens to join to each frame's own, [keyframes, tokens, channels]
    std::vector<std::optional<std::size_t>> left_out; ///< per frame, the keyframe of f_KF that it does not join
    Features const* F_KF = nullptr;          ///< eq. 6: F_bar^i = rows[i] * F_KF, by gather or by mix_rows
    std::vector<sparse_rows<Real>> rows;     ///< per frame, the plan; empty without F_KF
    Real alpha = 0;                          ///< eq. 6
    bool is_recorded = false;                ///< whether the graph's f and F are to be handed to `record_features`
};

/// The extra inputs that plain attention asks for: none.
template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(plain_attention const&, attention_place, std::span<frame_index const>) {
    return {};
}

/// The extra inputs of the keyframe pass.
template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(recorder<Features> const& pass, attention_place place,
                                         std::span<frame_index const>) {
    feature_inputs<Features, Real> inputs;
    inputs.attends_to_stack = pass.attends_to_stack(place);
    inputs.is_recorded = pass.records(place);
    return inputs;
}

/// The extra inputs of the injected pass for `frames`.
template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(injector<Features, Real> const& pass, attention_place place,
                                         std::span<frame_index const> frames) {
    feature_inputs<Features, Real> inputs;
    inputs.f_KF = pass.joined_features(place);
    for (auto const frame : frames) {
        inputs.left_out.push_back(pass.left_out(frame));
    }
    inputs.F_KF = pass.blended_features(place);
    if (inputs.F_KF != nullptr) {
        inputs.rows = pass.rows_at(place.site, frames);
        inputs.alpha = pass.alpha(place.site);
    }
    return inputs;
}

/// Hands the graph's extra outputs f and F [frames, tokens, channels] of a place to the pass that asked for them.
template <class Features>
void record_features(recorder<Features> const& pass, attention_place place, Features f, Features F) {
    pass.record(place, std::move(f), std::move(F));
}

} // namespace genrender
