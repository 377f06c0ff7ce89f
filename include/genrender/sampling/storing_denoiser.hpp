// SPDX-License-Identifier: MIT
// Whether a denoiser's features can be kept in 16 bits, asked before it is run.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/core/error.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <optional>

namespace genrender {

/// A denoiser that names the type of its calls, an optional capability: what these can do is known before a run then.
///
/// expression                | type           | meaning
/// --------------------------|----------------|-----------------------------------------------------------------------
/// `typename Phi::call_type` | attention_call | the calls that it hands to its processor
template <class Phi>
concept call_naming_denoiser = denoiser<Phi> && attention_call<typename Phi::call_type>;

/// Whether a denoiser can keep features in 16 bits, where its types tell: by its call_type if it names one, else yes if
/// its features are storable_features. A constant, for a static_assert of a program that asks for 16 bits.
template <denoiser Phi>
constexpr std::optional<bool> stores_16_bits() {
    if constexpr (call_naming_denoiser<Phi>) {
        return storing_attention_call<typename Phi::call_type>;
    } else if constexpr (storable_features<typename Phi::features_type>) {
        return true;
    } else {
        return std::nullopt;
    }
}

/// Throws value_error if features are to be kept in 16 bits by a denoiser of which it is known that it cannot. Others are
/// refused when the first place that takes part asks, before its graph runs or the place is computed.
template <denoiser Phi>
void require_storage(feature_storage storage) {
    if (storage != feature_storage::same && stores_16_bits<Phi>() == false) {
        throw value_error("render: settings.keyframe_storage is of 16 bits, expected feature_storage::same for a "
                          "denoiser whose call_type has no `stored`");
    }
}

/// What the compiler says of 16 bits that a denoiser cannot store.
#define GENRENDER_KEYFRAME_STORAGE                                                                                     \
    "keyframe_storage_for: storage is of 16 bits, expected feature_storage::same for a denoiser whose call_type has "  \
    "no `stored`"

/// `Storage`, for settings of runs with a denoiser of this type; does not compile if that is known not to store it:
///
///     settings.keyframe_storage = keyframe_storage_for<my_denoiser, feature_storage::f16>();
///
/// Of a denoiser that tells nothing (stores_16_bits is empty) it is believed, and refused by the run if it is wrong.
template <denoiser Phi, feature_storage Storage>
consteval feature_storage keyframe_storage_for() {
    static_assert(Storage == feature_storage::same || stores_16_bits<Phi>() != false, GENRENDER_KEYFRAME_STORAGE);
    return Storage;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
