// SPDX-License-Identifier: MIT
// [GR sec. 3.1] The front door of attention: what runs in place of a self-attention module.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>

#include <concepts>

namespace genrender {

/// Runs in place of a self-attention module and returns its output.
///
/// expression        | type                  | meaning
/// ------------------|-----------------------|-------------------------------------------------------------------------
/// `processor(call)` | `Call::features_type` | F [frames, tokens, channels], the output of the module for all frames of
///                   |                       | the call, before the residual is added
///
/// These the compiler cannot check, and a model owes them (tests/support/attention_processor_laws.hpp): F has the
/// extents of `call.f()`; calls at different places, or for different frames, may run at the same time on several
/// threads; the processor keeps no reference to the call. An engine owes the processor that it does not write into F,
/// which a recorder keeps: the residual is added elsewhere. It does not require to be copied, to know a network, or to
/// be called in any order of sites.
///
/// See also: plain_attention, recorder, injector and the baselines, which are models; attention_call, what it is given;
/// feature_io_processor, the same contract for engines whose graph is static.
template <class Processor, class Call>
concept attention_processor = attention_call<Call> && requires(Processor& processor, Call& call) {
    { processor(call) } -> std::convertible_to<typename Call::features_type>;
};

/// Whether a processor does at a place what plain_attention does, to the bit: what a network computes before its first
/// other place then depends on z, sigma and the frame alone, and can be reused. A processor says so by an optional
/// member `is_plain_at(place)`; nothing is known of one without it.
template <class Processor>
bool is_plain_at(Processor const& processor, attention_place place) {
    if constexpr (requires {
                      { processor.is_plain_at(place) } -> std::convertible_to<bool>;
                  }) {
        return processor.is_plain_at(place);
    } else {
        return false;
    }
}

/// The least that an attention_processor is, for checking denoisers; never run.
struct attention_processor_archetype {
    /// F of one run of a module, in place of its own attention.
    template <attention_call Call>
    typename Call::features_type operator()(Call& call);
};

} // namespace genrender

#include <genrender/core/end_header.inl>
