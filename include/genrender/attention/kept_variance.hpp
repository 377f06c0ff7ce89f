// SPDX-License-Identifier: MIT
// Whether eq. 6 keeps the variance that averaging takes from features, and which calls can.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>

#include <concepts>
#include <cstdint>
#include <span>

namespace genrender {

/// Which variance F_out of eq. 6 is given, in each channel over the covered tokens of a frame.
enum class variance_target : std::uint8_t {
    none, ///< the one that it has: eq. 6 as the paper has it
    total, ///< that of what was averaged, F_hat and sources, each by its share: what the law of total variance says is gone
    sources ///< that of the sources in F_KF, by their weights
};

/// How eq. 6 keeps variance (mix_rows_keeping_variance).
struct kept_variance {
    variance_target target = variance_target::none; ///< the variance that F_out is given
    double most_gain = 2; ///< deviations are multiplied by at most this and at least its inverse; 1 or more
};

/// Throws value_error, in the name of `function`, for a most_gain that is not finite or below 1.
inline void require_kept_variance(char const* function, kept_variance const& kept) {
    require_value(is_finite(kept.most_gain) && kept.most_gain >= 1, function, "most_gain", kept.most_gain,
                  "a finite number, 1 or more");
}

/// An attention_call that keeps variance in eq. 6, an optional capability: others are refused where it is to be kept.
///
/// expression                                                  | type            | meaning
/// ------------------------------------------------------------|-----------------|------------------------------------
/// `call.mix_keeping_variance(F_hat, F_KF, rows, alpha, kept)` | `features_type` | `mix`, of whose result deviations
///                                                             |                 | from the mean are rescaled, each
///                                                             |                 | frame for itself, as
///                                                             |                 | mix_rows_keeping_variance has it
///
/// A model owes that variance_target::none gives what `mix` gives and that rows that are not covered are those of F_hat.
template <class Call>
concept variance_keeping_call = attention_call<Call> &&
    requires(Call& call, typename Call::features_type const& x,
             std::span<sparse_rows<typename Call::real_type> const> rows, typename Call::real_type alpha,
             kept_variance const& kept) {
    { call.mix_keeping_variance(x, x, rows, alpha, kept) } -> std::convertible_to<typename Call::features_type>;
};

/// `call.mix`, with the variance kept that is asked for. Throws value_error if one is and the call is no
/// variance_keeping_call.
template <attention_call Call>
typename Call::features_type mixed_features(Call& call, typename Call::features_type const& F_hat,
                                            typename Call::features_type const& F_KF,
                                            std::span<sparse_rows<typename Call::real_type> const> rows,
                                            typename Call::real_type alpha, kept_variance const& kept) {
    if (kept.target == variance_target::none) {
        return call.mix(F_hat, F_KF, rows, alpha);
    }
    if constexpr (variance_keeping_call<Call>) {
        return call.mix_keeping_variance(F_hat, F_KF, rows, alpha, kept);
    } else {
        throw value_error("mixed_features: variance is to be kept, expected variance_target::none for an attention "
                          "call without `mix_keeping_variance`");
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
