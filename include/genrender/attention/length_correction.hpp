// SPDX-License-Identifier: MIT
// The length-corrected temperature: attention over the keys of many frames is made as sharp as that over a frame's own.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_call.hpp>
#include <genrender/attention/key_counts.hpp>
#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>

#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace genrender {

/// What logits are multiplied by where a query that the network gives `own` keys has `keys`:
///     scale = (ln keys / ln own)^power
/// A softmax over n keys of like logits has the entropy ln n: the scale lets it grow no faster than that of the network's
/// own. 1, to the bit, with power 0, as many keys as its own, or an own key or none. Throws value_error for a power that
/// is negative or not finite.
inline double length_correction(std::size_t own, std::size_t keys, double power) {
    require_value(is_finite(power) && power >= 0, "length_correction", "power", power, "a finite number, 0 or more");
    if (power == 0 || keys == own || own < 2 || keys < 2) {
        return 1.0;
    }
    return std::pow(std::log(static_cast<double>(keys)) / std::log(static_cast<double>(own)), power);
}

/// What the logits of a frame at a site are multiplied by whose tokens attend to so many frames' keys. Empty: 1.
using logit_scale_function = std::function<double(site_index site, std::size_t joined_frames)>;

/// length_correction with a power at each of some sites, of which every frame has the same tokens; empty with power 0.
template <class Sites>
logit_scale_function length_scale(Sites const& sites, double power) {
    if (power == 0) {
        return {};
    }
    std::vector<std::size_t> tokens;
    for (attention_site const& site : sites) {
        tokens.push_back(site.grid.size());
    }
    return [tokens = std::move(tokens), power](site_index site, std::size_t joined_frames) {
        auto const own = tokens.at(site.value);
        return length_correction(own, own * joined_frames, power);
    };
}

/// Sets the scale of every frame by the number of blocks that it attends to. Does nothing without a function.
template <class Features>
void scale_by_length(attention_sources<Features>& sources, site_index site, logit_scale_function const& scale_of) {
    if (!scale_of) {
        return;
    }
    std::vector<double> scales;
    for (auto const& blocks : std::as_const(sources)) {
        scales.push_back(scale_of(site, blocks.size()));
    }
    sources.set_scales(std::move(scales));
}

/// An attention_call that multiplies logits, an optional capability: others are refused where something is to be scaled.
///
/// expression            | type | meaning
/// ----------------------|------|--------------------------------------------------------------------------------
/// `Call::scales_logits` | bool | a constant, true: `attend(Q, sources)` multiplies the logits of frame i by
///                       |      | `sources.scale(i)`, beside the 1 / sqrt(d) of eq. 1
///
/// A model owes that a scale of 1 changes no bit. check_attention_call_laws checks that a scale is honoured.
template <class Call>
concept scaling_attention_call = attention_call<Call> && static_cast<bool>(Call::scales_logits);

/// `call.attend(Q, sources)`. Throws value_error if sources are scaled and the call is no scaling_attention_call, or count
/// keys and it is no counting_attention_call.
template <attention_call Call>
typename Call::features_type attend_scaled(Call& call, typename Call::features_type const& Q,
                                           attention_sources<typename Call::features_type> const& sources) {
    if constexpr (!scaling_attention_call<Call>) {
        if (sources.is_scaled()) {
            throw value_error("attend_scaled: logits are scaled, expected a length_correction of 0 for an attention "
                              "call without `scales_logits`");
        }
    }
    if constexpr (!counting_attention_call<Call>) {
        if (sources.counts_keys()) {
            throw value_error(
                "attend_scaled: keys are counted, expected counts_points to be false for an attention call "
                "without `counts_keys`");
        }
    }
    return call.attend(Q, sources);
}

} // namespace genrender

#include <genrender/core/end_header.inl>
