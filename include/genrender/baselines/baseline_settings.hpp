// SPDX-License-Identifier: MIT
// [GR sec. 4: Baselines] The settings of a run as the paper has them for the methods it compares with.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/pipeline/render_settings.hpp>

namespace genrender {

/// The settings of a run turned to those of Pix2Video* and TokenFlow*: "the same noise to initialize each frame", or
/// noise of another kind to compare methods alone, and neither latent normalisation nor a consensus, which are not
/// theirs. Steps, schedule, sampler, seeds, keyframes and layers stay.
template <class Real>
render_settings<Real> baseline_settings(render_settings<Real> settings, noise_kind noise = noise_kind::fixed) {
    settings.normalization.enabled = false;
    settings.consensus.enabled = false;
    settings.noise.kind = noise;
    return settings;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
