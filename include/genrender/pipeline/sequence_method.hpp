// SPDX-License-Identifier: MIT
// [GR sec. 3, 4] The front door of methods: how all frames of an animation are denoised at one noise level.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/pipeline/render_settings.hpp>

#include <concepts>
#include <cstddef>
#include <vector>

namespace genrender {

/// Denoises all frames of an animation at one noise level by its passes. Everything else of a run is the same
/// for every method: initial noise, noise levels, sampler, latent normalisation, progress and report.
///
/// expression                                   | type                | meaning
/// ---------------------------------------------|---------------------|-----------------------------------------------
/// `method.keyframes(settings, frames, step)`   | vector<frame_index> | the frames that it denoises in a pass of their
///                                              |                     | own in this step of an animation of `frames`
///                                              |                     | frames; empty for none. Throws value_error if
///                                              |                     | the settings do not fit
/// `method.uses_correspondence(settings)`       | bool                | whether correspondence maps are to be compiled
///                                              |                     | for the sites that take part
/// `method(passes)`                             | void                | writes the clean estimates of all frames by
///                                              |                     | the passes of a sequence_passes
///
/// `passes` is a sequence_passes of any denoiser and map, so operator() is a template. Its passes are
/// `record_keyframes`, `denoise_frames`, `denoise_frames_in_order` and `denoise_frames_alone`; it tells `settings()`,
/// `step()`, `frame_count()`, `takes_part(place)` and `alpha(site)`. `settings` are render_settings of the denoiser's
/// scalar; members are const and are called from one thread at a time.
///
/// These the compiler cannot check, and a model owes them (check_sequence_method_laws of
/// testing/sequence_method_laws.hpp checks them): every evaluation runs the keyframes it announced and every frame
/// once; estimates depend neither on the loop nor on `settings.frames_per_call`; equal arguments give equal estimates,
/// from any thread: nothing is kept from one evaluation to the next, banks of features least of all, and what is drawn
/// depends on the settings' seeds and the step alone. It does not require to read all settings; each model says which it leaves unread.
///
/// See also: generative_rendering, the paper's method; pix2video and tokenflow, its baselines; sequence_passes,
/// what it is given.
template <class Method, class Passes>
concept sequence_method = std::copyable<Method> &&
    requires(Method const& method, Passes const& passes, render_settings<typename Passes::real_type> const& settings,
             std::size_t number) {
    { method.keyframes(settings, number, number) } -> std::same_as<std::vector<frame_index>>;
    { method.uses_correspondence(settings) } -> std::convertible_to<bool>;
    { method(passes) } -> std::same_as<void>;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
