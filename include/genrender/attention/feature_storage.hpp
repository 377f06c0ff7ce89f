// SPDX-License-Identifier: MIT
// The formats in which features of keyframes may be kept until every frame has read them.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/core/error.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>

namespace genrender {

/// How K_KF, V_KF and F_KF are kept; what is computed with them is computed in the engine's own scalars.
enum class feature_storage : std::uint8_t {
    same, ///< as they were computed
    f16,  ///< float16, IEEE binary16: 11 bits of precision, numbers up to 65504
    bf16  ///< bfloat16, the upper half of a float: 8 bits of precision, the range of a float
};

/// Bytes of one kept value.
template <std::floating_point Real>
constexpr std::size_t feature_bytes(feature_storage storage) {
    return storage == feature_storage::same ? sizeof(Real) : 2;
}

/// An attention_call that can keep features in 16 bits, an optional capability.
///
/// expression                | type            | meaning
/// --------------------------|-----------------|-----------------------------------------------------------------------
/// `call.stored(x, storage)` | `features_type` | x rounded to the format, in memory of its own; `attend` takes it as
///                           |                 | keys and values beside others, `mix` as F_KF
///
/// A model owes that feature_storage::same returns x, and that every value of the result is the one of the format
/// nearest to x's.
template <class Call>
concept storing_attention_call = attention_call<Call> &&
    requires(Call& call, typename Call::features_type const& x, feature_storage storage) {
    { call.stored(x, storage) } -> std::convertible_to<typename Call::features_type>;
};

/// Throws value_error if features are to be kept in 16 bits and the engine's call cannot.
template <attention_call Call>
void require_storing_call(feature_storage storage) {
    if (storage != feature_storage::same && !storing_attention_call<Call>) {
        throw value_error("stored_features: storage is of 16 bits, expected feature_storage::same for an attention "
                          "call without `stored`");
    }
}

/// x in the format. Throws value_error if it is to be another one than it has and the engine's call cannot store it.
template <attention_call Call>
typename Call::features_type stored_features(Call& call, typename Call::features_type x, feature_storage storage) {
    require_storing_call<Call>(storage);
    if constexpr (storing_attention_call<Call>) {
        return storage == feature_storage::same ? x : call.stored(x, storage);
    } else {
        return x;
    }
}

/// Features that can be kept in 16 bits without a call, an optional capability of what a static graph puts out.
///
/// expression           | type       | meaning
/// ---------------------|------------|--------------------------------------------------------------------------------
/// `stored(x, storage)` | `Features` | as `call.stored(x, storage)` of a storing_attention_call; found in the namespace
///                      |            | of the features
template <class Features>
concept storable_features = requires(Features const& x, feature_storage storage) {
    { stored(x, storage) } -> std::convertible_to<Features>;
};

/// Throws value_error if features are to be kept in 16 bits and there is no `stored` for them.
template <class Features>
void require_storable_features(feature_storage storage) {
    if (storage != feature_storage::same && !storable_features<Features>) {
        throw value_error("stored_features: storage is of 16 bits, expected feature_storage::same for features without "
                          "`stored`");
    }
}

/// x in the format. Throws value_error if it is to be another one than it has and there is no `stored` for it.
template <class Features>
Features stored_features(Features x, feature_storage storage) {
    require_storable_features<Features>(storage);
    if constexpr (storable_features<Features>) {
        return storage == feature_storage::same ? x : stored(x, storage);
    } else {
        return x;
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
