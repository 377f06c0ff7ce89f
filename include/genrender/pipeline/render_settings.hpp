// SPDX-License-Identifier: MIT
// [GR sec. 3, 4] Everything about a run that is neither the scene nor the network, and its presets.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/attention/attention_site.hpp>
#include <genrender/attention/feature_storage.hpp>
#include <genrender/blending/blend_plan.hpp>
#include <genrender/blending/consensus_settings.hpp>
#include <genrender/core/index.hpp>
#include <genrender/correspondence/chosen_correspondence.hpp>
#include <genrender/injection/alpha_schedule.hpp>
#include <genrender/injection/injection_settings.hpp>
#include <genrender/keyframes/draw_keyframes.hpp>
#include <genrender/noise/initial_noise.hpp>
#include <genrender/normalization/adain.hpp>
#include <genrender/sampling/sampler.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <type_traits>

namespace genrender {

/// Which self-attention modules take part: all of the denoising network's decoder, in every guidance branch. The
/// encoder and a ControlNet stay as they are.
inline bool is_in_decoder(attention_site const& site, std::uint32_t /*branch*/) {
    return site.network == network_kind::denoising && site.part == network_part::decoder;
}

/// Settings of one run of Alg. 1, or of another sequence_method, which says what it leaves unread.
template <class Real>
struct render_settings {
    std::size_t steps = 50;                     ///< T, denoising steps
    Real sigma_min = Real(0.0292);              ///< lowest noise level before 0 (Stable Diffusion's)
    Real sigma_max = Real(14.6146);             ///< noise level of the initial latents
    Real rho = 7;                               ///< spacing of the levels [EDM eq. 5]
    sampler_kind sampler = sampler_kind::euler; ///< how the latents follow the estimates

    noise_settings noise;                   ///< sec. 3.3
    keyframe_settings keyframes;            ///< alg. 1: KF
    correspondence_settings correspondence; ///< sec. 3.2
    consensus_settings<Real> consensus;     ///< of the clean estimates; not the paper's
    adain_settings<Real> normalization;     ///< sec. 3.4

    /// Sites and branches that take part in the injection. Like alpha it may be called from several threads at once.
    std::function<bool(attention_site const&, std::uint32_t branch)> layers = is_in_decoder;
    /// alpha of eq. 6, by step and site.
    alpha_schedule<Real> alpha = constant_alpha(Real(paper_alpha));
    /// What alpha is multiplied by at sites of the latents' own grid, in [0, 1]; the paper's is 1. There a consensus makes
    /// frames agree, and eq. 6 besides makes them paler.
    Real latents_grid_alpha = 0;
    injection_settings injection;      ///< eq. 3, 5 and 6
    Real first_fill_share = Real(0.5); ///< of the inpainted texture in the unified one
    /// How the average texture weighs keyframes; plain is the paper's.
    texel_average average = texel_average::by_quality;
    quality_settings quality; ///< what qualities do besides; the default takes shares in proportion to quality
    /// Steps with keyframes and injection: those whose share step / steps lies in [window_begin, window_end).
    Real window_begin = 0;
    Real window_end = 1; ///< see window_begin

    feature_storage keyframe_storage = feature_storage::same; ///< how features of keyframes are kept
    /// Whether a denoiser that can (residual_lender) keeps what the keyframe pass has computed of keyframes: the same
    /// frames to the bit in less time, for memory that memory_plan tells.
    bool reuses_keyframes = true;
    std::size_t frames_per_call = 1; ///< frames that the injected pass gives the denoiser at once
    /// Whether the last call of a pass is given as many frames too, for graphs of one shape: the last frame again and
    /// again, whose further estimates are dropped. Not where frames are denoised in order (pix2video).
    bool fills_last_call = false;
    /// How many calls of the denoiser may run at the same time; the run's loop then shares the library's own work alone
    /// among more threads. 0 leaves it to the loop; 1 is for an engine with one graph, context or device.
    std::size_t calls_at_once = 0;

    /// Consistent and vivid, what measured best on development scenes (docs/presets.md): the defaults.
    static render_settings vivid() { return {}; }

    /// Alg. 1 alone, with the defaults' readings of the paper and nothing besides: no consensus, eq. 6 at every site, and
    /// latent normalisation, of means.
    static render_settings plain() {
        render_settings settings;
        settings.normalization.enabled = true;
        settings.consensus.enabled = false;
        settings.latents_grid_alpha = 1;
        return settings;
    }

    /// The paper to the letter, where it says what to do and the defaults do something else: Alg. 1 alone, texels and
    /// noise read from texels, T of both matched to the maps, average of keyframes alike, latent normalisation of mean and
    /// deviation.
    static render_settings paper() {
        auto settings = plain();
        settings.correspondence.kind = correspondence_kind::texel_grid;
        settings.average = texel_average::plain;
        settings.noise.reading = noise_reading::nearest_texel;
        settings.normalization.statistics = adain_statistics::mean_and_deviation;
        return settings;
    }

    /// Does not compile, with a sentence (pipeline/render.hpp): settings are of the scalar of the denoiser.
    template <class Other>
        requires(!std::is_same_v<Other, Real>)
    operator render_settings<Other>() const;
};

/// alpha of eq. 6 in a step at a site of a run whose latents have this grid.
template <class Real>
Real alpha_at(render_settings<Real> const& settings, std::size_t step, attention_site const& site,
              grid_extents latent_grid) {
    auto const share = site.grid == latent_grid ? settings.latents_grid_alpha : Real(1);
    return share > 0 ? share * settings.alpha(step, site) : Real(0);
}

/// Frames that a call of a pass over `frames` frames gives the denoiser, but for a shorter last one.
template <class Real>
std::size_t stack_size(render_settings<Real> const& settings, std::size_t frames) {
    return settings.fills_last_call ? settings.frames_per_call : std::min(settings.frames_per_call, frames);
}

/// Whether a step lies in the window [begin, end) of shares of all steps.
template <class Real>
bool is_in_window(std::size_t step, std::size_t steps, Real begin, std::type_identity_t<Real> end) {
    auto const share = static_cast<Real>(step) / static_cast<Real>(steps);
    return share >= begin && share < end;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
