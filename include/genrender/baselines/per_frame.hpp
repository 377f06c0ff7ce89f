// SPDX-License-Identifier: MIT
// [GR sec. 4: Per-Frame] The baseline that denoises every frame by itself.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/pipeline/render_settings.hpp>

namespace genrender {

/// The settings of a run turned into the Per-Frame baseline: no keyframes, no injection, no consensus, no latent
/// normalisation, and noise of `noise` kind; steps, schedule, sampler and seeds stay.
template <class Real>
render_settings<Real> per_frame(render_settings<Real> settings, noise_kind noise = noise_kind::independent) {
    settings.window_begin = 0;
    settings.window_end = 0;
    settings.injection.pre_attention = false;
    settings.injection.post_attention = false;
    settings.normalization.enabled = false;
    settings.consensus.enabled = false;
    settings.noise.kind = noise;
    return settings;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
