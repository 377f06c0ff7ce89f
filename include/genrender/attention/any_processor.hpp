// SPDX-License-Identifier: MIT
// Any attention processor behind one type, so that an engine's layers are compiled once for all of them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_processor.hpp>

#include <type_traits>

namespace genrender {

/// Any attention_processor of one engine's calls, itself a model: a reference to one that outlives it. An engine whose
/// layers take this instead of a template parameter is compiled once, and apart from the pipeline.
template <attention_call Call>
class any_processor {
public:
    using call_type = Call;                             ///< what the engine's modules hand over
    using features_type = typename Call::features_type; ///< the engine's handle of features

    /// Refers to any attention processor, which has to outlive this.
    template <class Processor>
        requires(!std::is_same_v<std::remove_const_t<Processor>, any_processor>)
    any_processor(Processor& processor)
        : processor_(&processor), run_([](void const* object, Call& call) -> features_type {
              return (*const_cast<Processor*>(static_cast<Processor const*>(object)))(call);
          }),
          is_plain_at_([](void const* object, attention_place place) {
              return genrender::is_plain_at(*static_cast<Processor const*>(object), place);
          }) {
        require_attention_processor<Processor, Call>();
    }

    /// Runs the processor.
    features_type operator()(Call& call) const { return run_(processor_, call); }
    /// What genrender::is_plain_at tells of the processor.
    bool is_plain_at(attention_place place) const { return is_plain_at_(processor_, place); }

private:
    void const* processor_;
    features_type (*run_)(void const*, Call&);
    bool (*is_plain_at_)(void const*, attention_place);
};

} // namespace genrender

#include <genrender/core/end_header.inl>
