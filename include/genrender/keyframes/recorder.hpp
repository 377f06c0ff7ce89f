// SPDX-License-Identifier: MIT
// [GR alg. 1: f_KF, F_KF <- Phi(z_KF, D_KF, c)] The processor of the keyframe pass: extended attention, features kept.
#pragma once

#include <genrender/attention/extended_attention.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/keyframes/feature_bank.hpp>

#include <functional>
#include <utility>

namespace genrender {

/// Which places take part in the injection; asked once per place and pass.
using place_filter = std::function<bool(attention_place)>;

/// Runs the keyframes of a step in lockstep and keeps their features in a bank. At places that the filter leaves out
/// the network stays as it is and nothing is kept.
template <class Features>
class recorder {
public:
    /// Records into `bank`, which must outlive the recorder. With `extended` keyframes attend to each other (eq. 3),
    /// else each to itself (the ablation without pre-attention injection).
    recorder(feature_bank<Features>& bank, place_filter takes_part, bool extended = true)
        : bank_(&bank), takes_part_(std::move(takes_part)), extended_(extended) {}

    /// F of eq. 1 over the sources of eq. 3; keeps K_KF, V_KF and F_KF of the place.
    template <attention_call Call>
    Features operator()(Call& call) const {
        auto const f = call.f();
        auto const frames = call.frames().size();
        auto const is_recorded = takes_part_(call.place());
        keyframe_features<Features> kept;
        auto const Q = call.query(f);
        kept.K_KF = call.key(f);
        kept.V_KF = call.value(f);
        auto const sources = is_recorded && extended_ ? extended_attention_sources(*kept.K_KF, *kept.V_KF, frames)
                                                      : own_attention_sources(*kept.K_KF, *kept.V_KF, frames);
        Features F = call.attend(Q, sources);
        if (is_recorded) {
            kept.F_KF = F;
            bank_->put(call.place(), std::move(kept));
        }
        return F;
    }

    /// Whether features of a place are kept.
    bool records(attention_place place) const { return takes_part_(place); }

    /// Whether frames of the stack attend to each other at a place; asked by engines whose graph is static.
    bool attends_to_stack(attention_place place) const { return extended_ && takes_part_(place); }

    /// Keeps features that a static graph gave out: its input f_KF and output F_KF at a place that takes part.
    void record(attention_place place, Features f_KF, Features F_KF) const {
        if (takes_part_(place)) {
            keyframe_features<Features> kept;
            kept.f_KF = std::move(f_KF);
            kept.F_KF = std::move(F_KF);
            bank_->put(place, std::move(kept));
        }
    }

private:
    feature_bank<Features>* bank_;
    place_filter takes_part_;
    bool extended_;
};

} // namespace genrender
