// SPDX-License-Identifier: MIT
// [GR sec. 3.1] The front door of attention: what runs in place of a self-attention module.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/attention_site.hpp>

#include <concepts>

namespace genrender {

/// Runs in place of a self-attention module and returns its output. A denoiser calls it once for every site and
/// guidance branch of its call; the sequence_method makes it.
///
/// expression        | type                  | meaning
/// ------------------|-----------------------|-------------------------------------------------------------------------
/// `processor(call)` | `Call::features_type` | F [frames, tokens, channels], the output of the module for all frames of
///                   |                       | the call, before the residual is added; `call`, an lvalue, is the
///                   |                       | engine's attention_call
///
/// A processor for every engine makes operator() a template of attention_call and takes elements from nowhere but the
/// call's operations; one for a single engine may take that engine's call type alone. The library's denoisers call
/// const processors and others.
///
/// These the compiler cannot check, and a model owes them (check_attention_processor_laws of
/// testing/attention_processor_laws.hpp checks them): F has the extents of `call.f()`, which is not changed; calls at
/// different places, or for different frames, may run at the same time on several threads; the processor keeps no
/// reference to the call, handles it may keep. An engine owes the processor that it does not write into F, which a
/// recorder keeps: the residual is added elsewhere. It does not require to be copied, to know a network, or to be
/// called in any order of sites.
///
/// Optional capability: partly_plain_processor.
/// See also: plain_attention, recorder, injector and the baselines, which are models; attention_call, what it is given;
/// feature_io_processor, the same contract for engines whose graph is static.
template <class Processor, class Call>
concept attention_processor = attention_call<Call> && requires(Processor& processor, Call& call) {
    { processor(call) } -> std::convertible_to<typename Call::features_type>;
};

/// Fails to compile with a sentence for what an attention_processor of these calls lacks.
template <class Processor, class Call>
consteval void require_attention_processor() {
    require_attention_call<Call>();
    static_assert(
        requires(Processor & processor, Call & call) {
            { processor(call) } -> std::convertible_to<typename Call::features_type>;
        },
        "attention_processor: operator()(call) takes the engine's attention_call as an lvalue and returns its "
        "features_type");
}

/// An attention_processor that tells where it does what plain_attention does, an optional capability: what a network
/// computes before its first other place then depends on z, sigma and the frame alone, and can be reused
/// (residual_lender).
///
/// expression                     | type | meaning
/// -------------------------------|------|----------------------------------------------------------------------------
/// `processor.is_plain_at(place)` | bool | whether its F at the place is that of plain_attention, to the bit; const
template <class Processor>
concept partly_plain_processor = requires(Processor const& processor, attention_place place) {
    { processor.is_plain_at(place) } -> std::convertible_to<bool>;
};

/// Whether a processor does at a place what plain_attention does, to the bit; false for one that does not tell.
template <class Processor>
bool is_plain_at(Processor const& processor, attention_place place) {
    if constexpr (partly_plain_processor<Processor>) {
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
