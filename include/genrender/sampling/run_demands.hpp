// SPDX-License-Identifier: MIT
// Whether a denoiser's calls can do what a run asks for beyond eqs. 1 to 6, asked before it is run.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/kept_variance.hpp>
#include <genrender/attention/length_correction.hpp>
#include <genrender/core/error.hpp>
#include <genrender/sampling/run_shapes.hpp>
#include <genrender/sampling/storing_denoiser.hpp>

namespace genrender {

/// Throws value_error if a run scales logits, counts keys or keeps variance and the call_type of its denoiser cannot. Denoisers that name
/// no call_type are refused when the first place that takes part asks, before it is computed.
template <denoiser Phi>
void require_demands([[maybe_unused]] run_shapes const& shapes) {
    if constexpr (call_naming_denoiser<Phi>) {
        if (shapes.scales_logits && !scaling_attention_call<typename Phi::call_type>) {
            throw value_error(
                "render: settings.injection.length_correction is above 0, expected 0 for a denoiser whose "
                "call_type has no `scales_logits`");
        }
        if (shapes.counts_keys && !counting_attention_call<typename Phi::call_type>) {
            throw value_error("render: settings.injection.counts_points is true, expected false for a denoiser whose "
                              "call_type has no `counts_keys`");
        }
        if (shapes.keeps_variance && !variance_keeping_call<typename Phi::call_type>) {
            throw value_error("render: settings.injection.variance is to be kept, expected variance_target::none for a "
                              "denoiser whose call_type has no `mix_keeping_variance`");
        }
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
