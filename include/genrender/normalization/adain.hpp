// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Latent normalisation: AdaIN that gives every frame's background the statistics of the first frame's.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/vectors.hpp>
#include <genrender/normalization/channel_statistics.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#define GENRENDER_KERNELS <genrender/normalization/adain.inl>
#include <genrender/core/each_target.inl>

namespace genrender {

inline namespace GENRENDER_UNIT {

/// Rescales z [channels, height, width] in place, all of its pixels, so that statistics `from` become statistics `to`:
/// z_c = (z_c - mean_from) / deviation_from * deviation_to + mean_to. Throws shape_error if channels differ.
template <class Real>
void adain(strided_view<Real, 3> z, channel_statistics<std::type_identity_t<Real>> const& from,
           channel_statistics<std::type_identity_t<Real>> const& to) {
    require_extents("adain", "from", std::array{from.mean.size()}, std::array{z.extent(0)});
    require_extents("adain", "to", std::array{to.mean.size()}, std::array{z.extent(0)});
    for (std::size_t c = 0; c < z.extent(0); ++c) {
        auto const scale = to.deviation[c] / from.deviation[c];
        if (z[c].is_contiguous()) {
            GENRENDER_KERNEL(detail, rescale<Real>)(z[c].data(), z[c].size(), from.mean[c], scale, to.mean[c]);
            continue;
        }
        for (std::size_t row = 0; row < z.extent(1); ++row) {
            for (std::size_t column = 0; column < z.extent(2); ++column) {
                auto& value = z(c, row, column);
                value = (value - from.mean[c]) * scale + to.mean[c];
            }
        }
    }
}

} // namespace GENRENDER_UNIT

/// What latent normalisation does to a frame with hardly any background.
enum class without_background : std::uint8_t {
    skip,      ///< leave the frame as it is and report it
    all_pixels ///< take the statistics of all of its pixels, and of all pixels of the first frame
};

/// Which statistics latent normalisation makes alike.
enum class adain_statistics : std::uint8_t {
    mean,              ///< means alone
    mean_and_deviation ///< the paper's: nearly flat backgrounds have no deviation to divide by, and burn or wash out
};

/// How latents are normalised.
template <class Real>
struct adain_settings {
    bool enabled = true;                                  ///< whether latents are normalised at all
    adain_statistics statistics = adain_statistics::mean; ///< what is made alike
    /// Steps in which it runs: those whose share step / steps lies in [window_begin, window_end).
    Real window_begin = 0;
    Real window_end = 1;          ///< see window_begin
    std::size_t least_pixels = 2; ///< background pixels below which `fallback` decides; at least 2
    without_background fallback = without_background::skip; ///< what becomes of a frame with fewer background pixels
    bool on_noisy_latents = false; ///< normalise z_{t-1} after the sampler's step instead of the clean estimates
};

namespace detail {

/// Normalises frames by `rescale(i, from, to)`, called for each frame that changes, with what `statistics(i,
/// of_all_pixels)` tells of a frame's background or of all of it. Returns the frames that were skipped.
template <class Real, class Statistics, class Rescale>
std::vector<std::size_t> normalize_frames(std::size_t frames, adain_settings<Real> const& settings,
                                          Statistics const& statistics, Rescale const& rescale) {
    auto const least = std::max<std::size_t>(settings.least_pixels, 2);
    auto const rescale_to = [&](std::size_t i, channel_statistics<Real> from, channel_statistics<Real> const& to) {
        if (settings.statistics == adain_statistics::mean) {
            from.deviation = to.deviation;
        }
        rescale(i, from, to);
    };
    std::vector<std::size_t> skipped;
    if (frames == 0) {
        return skipped;
    }
    // Frame 0 stays as it is, so its statistics can be taken before the others change.
    auto const first = statistics(0, false);
    for (std::size_t i = 0; i < frames; ++i) {
        auto const own = statistics(i, false);
        if (own.pixels >= least && first.pixels >= least) {
            if (i > 0) {
                rescale_to(i, own, first);
            }
        } else if (settings.fallback == without_background::all_pixels) {
            if (i > 0) {
                rescale_to(i, statistics(i, true), statistics(0, true));
            }
        } else {
            skipped.push_back(i);
        }
    }
    return skipped;
}

} // namespace detail

inline namespace GENRENDER_UNIT {

/// Normalises a sequence z [frames, channels, height, width] in place: each frame's statistics over its own
/// `background` [frames, height, width], means and deviations or means alone, become those of frame 0 over its own.
/// Returns the frames that were skipped for want of background (all of them if frame 0 has none). Throws shape_error if
/// the mask does not fit.
template <class Real>
std::vector<std::size_t> normalize_latents(strided_view<Real, 4> z, strided_view<std::uint8_t const, 3> background,
                                           adain_settings<std::type_identity_t<Real>> const& settings = {}) {
    require_shape("normalize_latents", "background", background, {z.extent(0), z.extent(2), z.extent(3)});
    std::vector<std::uint8_t> const everywhere(z.extent(2) * z.extent(3), 1);
    strided_view<std::uint8_t const, 2> const all(everywhere.data(), {z.extent(2), z.extent(3)});
    return detail::normalize_frames(
        z.extent(0), settings,
        [&](std::size_t i, bool of_all_pixels) {
            return masked_statistics(strided_view<Real const, 3>(z[i]), of_all_pixels ? all : background[i]);
        },
        [&](std::size_t i, channel_statistics<Real> const& from, channel_statistics<Real> const& to) {
            adain(z[i], from, to);
        });
}

GENRENDER_INSTANCE(normalize_latents<float>);
GENRENDER_INSTANCE(normalize_latents<double>);

} // namespace GENRENDER_UNIT

} // namespace genrender

#include <genrender/core/end_header.inl>
