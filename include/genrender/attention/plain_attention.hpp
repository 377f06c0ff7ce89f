// SPDX-License-Identifier: MIT
// [GR eq. 2] The processor that leaves a network as it is: every frame attends to itself.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/projected_features.hpp>

#include <cstddef>
#include <type_traits>

namespace genrender {

/// The sources of a network's own self-attention: frame i attends to frame i of K and V. The result points to K and V.
template <class Features>
attention_sources<Features> own_attention_sources(Features const& K, Features const& V, std::size_t frames) {
    return attention_sources<Features>::own(K, V, frames);
}

/// Runs the module as the network has it.
struct plain_attention {
    /// F of eq. 1 with the queries, keys and values of eq. 2.
    template <attention_call Call>
    typename Call::features_type operator()(Call& call) const {
        auto const own = projections_of(call, call.f());
        return call.attend(own.Q, own_attention_sources(own.K, own.V, call.frames().size()));
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

    /// Everywhere.
    bool is_plain_at(attention_place) const { return true; }
};

} // namespace genrender

#include <genrender/core/end_header.inl>
