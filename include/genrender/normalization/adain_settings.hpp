// SPDX-License-Identifier: MIT
// What latent normalisation makes alike, with whose, and how far it may go.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>

#include <cstddef>
#include <cstdint>

namespace genrender {

/// What latent normalisation does to a frame with hardly any background.
enum class without_background : std::uint8_t {
    skip,      ///< leave the frame as it is and report it
    all_pixels ///< take the statistics of all of its pixels, and of all pixels of the target
};

/// Which statistics latent normalisation makes alike.
enum class adain_statistics : std::uint8_t {
    mean,               ///< means alone
    mean_and_deviation, ///< the paper's: nearly flat backgrounds have no deviation to divide by, and burn or wash out
    /// Means, and deviations as far as their pixels support a difference (supported_gain).
    mean_and_supported_deviation,
    /// Low bands, place by place, where both are background (low_band.hpp): high bands stay the frame's, nothing is
    /// divided. For backgrounds that stand still on the screen.
    low_band
};

/// Whose statistics those of all frames become.
enum class adain_target : std::uint8_t {
    first_frame,          ///< frame 0's, the paper's
    all_frames,           ///< those of the backgrounds of all frames together, so that no frame alone decides
    first_with_background ///< of the first frame with enough background, else of the one with most
};

/// How latents are normalised.
template <class Real>
struct adain_settings {
    bool enabled = false; ///< whether a run normalises latents at all; a consensus of the background makes it needless
    adain_statistics statistics = adain_statistics::mean; ///< what is made alike
    adain_target target = adain_target::first_frame;      ///< with whose
    /// Steps in which it runs: those whose share step / steps lies in [window_begin, window_end).
    Real window_begin = 0;
    Real window_end = 1;          ///< see window_begin
    std::size_t least_pixels = 2; ///< background pixels below which `fallback` decides; at least 2
    without_background fallback = without_background::skip; ///< what becomes of a frame with fewer background pixels
    bool on_noisy_latents = false; ///< normalise z_{t-1} after the sampler's step instead of the clean estimates

    Real enough_background = Real(0.1); ///< share of a frame's pixels, for adain_target::first_with_background
    Real standard_errors = 2;    ///< by which mean_and_supported_deviation lets deviations differ and changes nothing
    Real most_gain = Real(1.1);  ///< the most that it multiplies or divides by
    std::size_t band_levels = 4; ///< of low_band: what is coarser than about 2^levels pixels, 1 to 12
};

/// Throws value_error for settings that no run could honour, in the name of `function`.
template <class Real>
void require_adain_settings(char const* function, adain_settings<Real> const& settings) {
    require_value(settings.enough_background >= 0 && settings.enough_background <= 1, function,
                  "settings.enough_background", settings.enough_background, "a share in [0, 1]");
    require_value(settings.standard_errors >= 0, function, "settings.standard_errors", settings.standard_errors,
                  "a number of at least 0");
    require_value(settings.most_gain >= 1, function, "settings.most_gain", settings.most_gain,
                  "a factor of at least 1");
    require_value(settings.band_levels >= 1 && settings.band_levels <= 12, function, "settings.band_levels",
                  settings.band_levels, "1 to 12");
}

} // namespace genrender

#include <genrender/core/end_header.inl>
