// SPDX-License-Identifier: MIT
// Q, K and V of features at once, for engines whose module has one matrix for the three.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>

#include <concepts>

namespace genrender {

/// Queries, keys and values of a stack of features, each [frames, tokens, channels].
template <class Features>
struct projected_features {
    Features Q; ///< W^Q f
    Features K; ///< W^K f
    Features V; ///< W^V f
};

/// An attention_call that projects features to Q, K and V in one operation, an optional capability: others are asked for
/// the three one after the other.
///
/// expression        | type                                | meaning
/// ------------------|-------------------------------------|---------------------------------------------------------
/// `call.project(f)` | `projected_features<features_type>` | W^Q f, W^K f and W^V f of the call's own f; what
///                   |                                     | `query`, `key` and `value` give, up to rounding
///
/// check_attention_call_laws of testing/attention_call_laws.hpp checks that. `query`, `key` and `value` stay required:
/// keys and values of a stack are asked for alone too.
template <class Call>
concept projecting_attention_call = attention_call<Call> &&
    requires(Call& call, typename Call::features_type const& f) {
    { call.project(f) } -> std::convertible_to<projected_features<typename Call::features_type>>;
};

/// Q, K and V of f, by `call.project` where the call has it.
template <attention_call Call>
projected_features<typename Call::features_type> projections_of(Call& call, typename Call::features_type const& f) {
    if constexpr (projecting_attention_call<Call>) {
        return call.project(f);
    } else {
        return {call.query(f), call.key(f), call.value(f)};
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
