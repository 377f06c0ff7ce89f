// SPDX-License-Identifier: MIT
// [GR alg. 1: f_KF, F_KF <- Phi(z_KF, D_KF, c)] The processor of the keyframe pass: extended attention, features kept.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/extended_attention.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/attention/key_counts.hpp>
#include <genrender/attention/length_correction.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/keyframes/feature_bank.hpp>

#include <cstddef>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

/// Which places take part in the injection; asked once per place and pass.
using place_filter = std::function<bool(attention_place)>;

/// Runs the keyframes of a step in lockstep and keeps their features in a bank. At places that the filter leaves out
/// the network stays as it is and nothing is kept.
template <class Features>
class recorder {
public:
    /// Records into `bank`, which must outlive the recorder. With `extended` keyframes attend to each other (eq. 3),
    /// else each to itself (the ablation without pre-attention injection). Features are kept in the format of
    /// `storage`; keyframes attend to each other before they are rounded to it, with logits times `scale_of` and
    /// keys that count as `counts_of` says.
    recorder(feature_bank<Features>& bank, place_filter takes_part, bool extended = true,
             feature_storage storage = feature_storage::same, logit_scale_function scale_of = {},
             key_count_function counts_of = {})
        : bank_(&bank), takes_part_(std::move(takes_part)), extended_(extended), storage_(storage),
          scale_of_(std::move(scale_of)), counts_of_(std::move(counts_of)) {}

    /// F of eq. 1 over the sources of eq. 3; keeps K_KF, V_KF and F_KF of the place, in 16 bits as `stored` gives them,
    /// which is asked in this order. Throws value_error before anything is computed if the call cannot store features
    /// in the format asked for, or scale logits.
    template <attention_call Call>
    Features operator()(Call& call) const {
        auto const frames = call.frames().size();
        auto const is_recorded = takes_part_(call.place());
        if (is_recorded) {
            require_storing_call<Call>(storage_);
        }
        projected_features<Features> const own = projections_of(call, call.f());
        auto sources = is_recorded && extended_ ? extended_attention_sources(own.K, own.V, frames)
                                                : own_attention_sources(own.K, own.V, frames);
        scale_by_length(sources, call.place().site, scale_of_);
        auto const counts_of = is_recorded && extended_ ? counts_of_ : nullptr;
        auto const counts = count_keys(sources, call.place().site, call.frames(), counts_of);
        Features F = attend_scaled(call, own.Q, sources);
        if (is_recorded) {
            keyframe_features<Features> kept;
            kept.K_KF = stored_features(call, own.K, storage_);
            kept.V_KF = stored_features(call, own.V, storage_);
            kept.F_KF = stored_features(call, F, storage_);
            bank_->put(call.place(), std::move(kept));
        }
        return F;
    }

    /// Says what a call lacks that is none.
    template <class Call>
        requires(!attention_call<Call>)
    auto operator()(Call&) const { require_attention_call<Call>(); }

    /// Says that a call is no temporary.
    template <class Call>
    auto operator()(Call const&&) const {
        static_assert(std::is_void_v<Call>, GENRENDER_CALL_IS_LVALUE);
    }

    /// Whether features of a place are kept. Throws value_error if they are and `record` could not store them.
    bool records(attention_place place) const {
        auto const takes_part = takes_part_(place);
        if (takes_part) {
            require_storable_features<Features>(storage_);
        }
        return takes_part;
    }

    /// Where nothing is kept.
    bool is_plain_at(attention_place place) const { return !takes_part_(place); }

    /// Whether frames of the stack attend to each other at a place; asked by engines whose graph is static.
    bool attends_to_stack(attention_place place) const { return extended_ && takes_part_(place); }

    /// What the logits of the frames of a stack are multiplied by at a place, one a frame; none if all by 1.
    std::vector<double> scales(attention_place place, std::size_t frames) const {
        auto const scale = scale_of_ && attends_to_stack(place) ? scale_of_(place.site, frames) : 1.0;
        return scale == 1.0 ? std::vector<double>{} : std::vector<double>(frames, scale);
    }

    /// Whether keys at a place do not count for one each.
    bool counts_keys(attention_place place) const { return counts_of_ && attends_to_stack(place); }

    /// Notes that a static graph has asked what to do at a place that takes part: it owes `record` its features.
    void note_question(attention_place place) const {
        if (takes_part_(place)) {
            bank_->note_question(place);
        }
    }

    /// Keeps features that a static graph gave out: its input f_KF and output F_KF at a place that takes part. Throws
    /// value_error if they cannot be stored in the format asked for.
    void record(attention_place place, Features f_KF, Features F_KF) const {
        if (takes_part_(place)) {
            keyframe_features<Features> kept;
            kept.f_KF = stored_features(std::move(f_KF), storage_);
            kept.F_KF = stored_features(std::move(F_KF), storage_);
            bank_->put(place, std::move(kept));
        }
    }

private:
    feature_bank<Features>* bank_;
    place_filter takes_part_;
    bool extended_;
    feature_storage storage_;
    logit_scale_function scale_of_;
    key_count_function counts_of_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
