// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi as a static graph] The second way in: a graph's extra inputs and outputs at each site.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_processor.hpp>
#include <genrender/attention/kept_variance.hpp>
#include <genrender/attention/plain_attention.hpp>
#include <genrender/core/error.hpp>
#include <genrender/injection/graph_abilities.hpp>
#include <genrender/injection/injector.hpp>
#include <genrender/keyframes/recorder.hpp>

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

/// The extra inputs of one run of a static graph at one place. Every member is known before the graph starts, because
/// Alg. 1 finishes the keyframe pass before the injected pass begins. What it points to lives as long as the processor
/// and is kept as the recorder was told (feature_storage): the graph's own tensors, or their values in 16 bits.
template <class Features, class Real>
struct feature_inputs {
    bool attends_to_stack = false;  ///< eq. 3: keys and values of all frames of the stack
    Features const* f_KF = nullptr; ///< eq. 5: joined to each frame's own f, [keyframes, tokens, channels]
    std::vector<std::optional<std::size_t>> left_out; ///< per frame, the keyframe of f_KF that it does not join
    Features const* F_KF = nullptr;                   ///< eq. 6: F_bar^i = rows[i] * F_KF, by gather or by mix_rows
    std::vector<sparse_rows<Real>> rows;              ///< per frame, the plan; empty without F_KF
    Real alpha = 0;                                   ///< eq. 6
    /// What the logits of each frame are multiplied by, beside 1 / sqrt(d); empty if all by 1, as it is for engines
    /// whose graph_abilities do not say scales_logits.
    std::vector<double> scales{};
    kept_variance variance{}; ///< that eq. 6 keeps; none for engines whose graph_abilities do not say keeps_variance
    bool is_recorded = false; ///< whether the graph's f and F are to be handed to `record_features`
};

namespace detail {

/// Throws value_error for inputs that ask for more than the engine says that it can.
template <class Features, class Real>
void require_abilities_for(feature_inputs<Features, Real> const& inputs, graph_abilities abilities) {
    if (!inputs.scales.empty() && !abilities.scales_logits) {
        throw value_error("inputs_at: logits are scaled, expected a length_correction of 0 for an engine whose "
                          "graph_abilities do not say scales_logits");
    }
    if (inputs.variance.target != variance_target::none && !abilities.keeps_variance) {
        throw value_error("inputs_at: variance is to be kept, expected variance_target::none for an engine whose "
                          "graph_abilities do not say keeps_variance");
    }
}

/// Throws value_error for a pass that counts keys, which no static graph is told.
template <class Pass>
void require_uncounted(Pass const& pass, attention_place place) {
    if (pass.counts_keys(place)) {
        throw value_error("inputs_at: keys are counted, expected counts_points to be false for a static graph");
    }
}

} // namespace detail

/// The extra inputs that plain attention asks for: none.
template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(plain_attention const&, attention_place, std::span<frame_index const>,
                                         graph_abilities = {}) {
    return {};
}

/// The extra inputs of the keyframe pass. Throws value_error if features of the place are to be kept in 16 bits and have
/// no `stored`, or logits are scaled and the engine does not say that it can.
template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(recorder<Features> const& pass, attention_place place,
                                         std::span<frame_index const> frames, graph_abilities abilities = {}) {
    feature_inputs<Features, Real> inputs;
    inputs.attends_to_stack = pass.attends_to_stack(place);
    inputs.is_recorded = pass.records(place);
    inputs.scales = pass.scales(place, frames.size());
    detail::require_uncounted(pass, place);
    detail::require_abilities_for(inputs, abilities);
    pass.note_question(place);
    return inputs;
}

/// The extra inputs of the injected pass for `frames`. Throws value_error if the keyframe pass ran with callbacks,
/// which keep no f_KF, or asks for more than the engine says that it can.
template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(injector<Features, Real> const& pass, attention_place place,
                                         std::span<frame_index const> frames, graph_abilities abilities = {}) {
    feature_inputs<Features, Real> inputs;
    detail::require_uncounted(pass, place);
    inputs.f_KF = pass.joined_features(place);
    if (inputs.f_KF != nullptr) {
        inputs.scales = pass.scales(place, frames);
        for (auto const frame : frames) {
            inputs.left_out.push_back(pass.left_out(frame));
        }
    }
    inputs.F_KF = pass.blended_features(place);
    if (inputs.F_KF != nullptr) {
        inputs.rows = pass.rows_at(place.site, frames);
        inputs.alpha = pass.alpha(place.site);
        inputs.variance = pass.variance();
    }
    detail::require_abilities_for(inputs, abilities);
    return inputs;
}

/// Hands the graph's extra outputs f and F [frames, tokens, channels] of a place to the pass that asked for them, which
/// keeps until the step ends the handles, or their values in the 16 bits that the recorder was told. F_KF is then the
/// same to the bit as where the processor is called back; there K_KF and V_KF are rounded, here the f_KF that the graph
/// makes them of. Throws value_error if such features cannot be stored (storable_features).
template <class Features>
void record_features(recorder<Features> const& pass, attention_place place, std::type_identity_t<Features> f,
                     std::type_identity_t<Features> F) {
    pass.record(place, std::move(f), std::move(F));
}

/// Plain attention asks for no outputs: does nothing.
template <class Features>
void record_features(plain_attention const&, attention_place, Features const&, Features const&) {}

/// The injected pass asks for no outputs: does nothing.
template <class Features, class Real>
void record_features(injector<Features, Real> const&, attention_place, std::type_identity_t<Features> const&,
                     std::type_identity_t<Features> const&) {}

/// Says before a static graph runs what its self-attention modules are to do, and takes their features when it has run:
/// the contract of attention_processor without a callback. Both functions are found in the namespace of the processor.
///
/// expression                               | type                   | meaning
/// -----------------------------------------|------------------------|------------------------------------------------
/// `inputs_at<Features, Real>(processor,`   | feature_inputs         | what the module at `place` is given beside its
/// `    place, frames)`                     |   `<Features, Real>`   | weights, for the stack of these frames
/// `record_features(processor, place, f, F)`| void                   | takes input and output of the module for all
///                                          |                        | frames of the stack; called after the graph, for
///                                          |                        | the places whose inputs say `is_recorded`
///
/// These the compiler cannot check, and a model owes them: the inputs of all places can be asked for before the graph
/// starts, in any order, for different frames on several threads; a graph that honours them puts out the F that the
/// processor returns where it is called back, up to rounding.
/// It does not require that one type serves both forms; those of the library do.
///
/// See also: attention_processor, the same contract for engines that call back; plain_attention, recorder and injector,
/// which are models.
template <class Processor, class Features, class Real>
concept feature_io_processor = requires(Processor const& processor, attention_place place,
                                        std::span<frame_index const> frames, Features const& f) {
    { inputs_at<Features, Real>(processor, place, frames) } -> std::same_as<feature_inputs<Features, Real>>;
    record_features(processor, place, f, f);
};

/// A feature_io_processor that may ask for more than eqs. 1 to 6, an optional capability: others never do.
///
/// expression                                                   | type           | meaning
/// -------------------------------------------------------------|----------------|--------------------------------------
/// `inputs_at<Features, Real>(processor, place, frames, able)`  | feature_inputs | the same for an engine of these
///                                                              |                | graph_abilities. Throws value_error
///                                                              |                | if it is to do what it cannot
///
/// A model owes that the form without abilities throws where it asks for any.
template <class Processor, class Features, class Real>
concept demanding_feature_io_processor = feature_io_processor<Processor, Features, Real> &&
    requires(Processor const& processor, attention_place place, std::span<frame_index const> frames,
             graph_abilities able) {
    { inputs_at<Features, Real>(processor, place, frames, able) } -> std::same_as<feature_inputs<Features, Real>>;
};

/// The inputs of a place for an engine of these abilities, by the form of inputs_at that the processor has.
template <class Features, class Real, class Processor>
feature_inputs<Features, Real> inputs_for(Processor const& processor, attention_place place,
                                          std::span<frame_index const> frames, graph_abilities able) {
    if constexpr (demanding_feature_io_processor<Processor, Features, Real>) {
        return inputs_at<Features, Real>(processor, place, frames, able);
    } else {
        return inputs_at<Features, Real>(processor, place, frames);
    }
}

/// The least that a feature_io_processor is, for checking denoisers; never run. The archetype of both ways in is one,
/// so that the concept denoiser also holds for engines that ask for a feature_io_processor.
using feature_io_processor_archetype = attention_processor_archetype;
/// The inputs of a place; never run.
template <class Features, class Real>
feature_inputs<Features, Real> inputs_at(feature_io_processor_archetype const&, attention_place,
                                         std::span<frame_index const>, graph_abilities able = {});
/// Takes what a place put out; never run.
template <class Features>
void record_features(feature_io_processor_archetype const&, attention_place, Features const&, Features const&);

} // namespace genrender

#include <genrender/core/end_header.inl>
