// SPDX-License-Identifier: MIT
// What a static graph can do beyond eqs. 1 to 6: what it does not say is refused, never left out.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/sampling/run_shapes.hpp>

#include <string>

namespace genrender {

/// What an engine of static graphs reads of the inputs of a place beyond eqs. 1 to 6, told by the engine where it asks for
/// them (inputs_at).
struct graph_abilities {
    bool scales_logits = false;  ///< feature_inputs::scales
    bool keeps_variance = false; ///< feature_inputs::variance
};

/// Throws value_error, in the name of `function`, if a run asks its denoiser for more than these abilities.
inline void require_abilities(char const* function, graph_abilities abilities, run_shapes const& shapes) {
    auto const require = [&](bool holds, char const* what, char const* expected) {
        if (!holds) {
            throw value_error(std::string(function) + ": " + what + " is true, expected " + expected);
        }
    };
    require(abilities.scales_logits || !shapes.scales_logits, "shapes.scales_logits",
            "a length_correction of 0 for graphs that do not scale logits");
    require(!shapes.counts_keys, "shapes.counts_keys", "counts_points to be false for a static graph");
    require(abilities.keeps_variance || !shapes.keeps_variance, "shapes.keeps_variance",
            "variance_target::none for graphs that do not keep the variance of eq. 6");
}

} // namespace genrender

#include <genrender/core/end_header.inl>
