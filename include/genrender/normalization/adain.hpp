// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Latent normalisation: AdaIN that gives every frame's background the statistics of one of them, or of all.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/core/vectors.hpp>
#include <genrender/normalization/adain_settings.hpp>
#include <genrender/normalization/channel_statistics.hpp>
#include <genrender/normalization/low_band_latents.hpp>
#include <genrender/normalization/normalization_target.hpp>
#include <genrender/normalization/supported_gain.hpp>

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

namespace detail {

/// Normalises frames by `rescale(i, from, to)`, called for each frame that changes, with what `statistics(i,
/// of_all_pixels)` tells of a frame's background or of all of it; a frame is asked for before it changes. Returns the
/// frames that were skipped.
template <class Real, class Statistics, class Rescale>
std::vector<std::size_t> normalize_frames(strided_view<std::uint8_t const, 3> background,
                                          adain_settings<Real> const& settings, Statistics const& statistics,
                                          Rescale const& rescale) {
    auto const frames = background.extent(0);
    auto const least = std::max<std::size_t>(settings.least_pixels, 2);
    auto const rescale_to = [&](std::size_t i, channel_statistics<Real> from, channel_statistics<Real> to) {
        for (std::size_t c = 0; c < from.mean.size() && settings.statistics != adain_statistics::mean_and_deviation;
             ++c) {
            to.deviation[c] = settings.statistics == adain_statistics::mean
                                  ? Real{1}
                                  : supported_gain(from.deviation[c], from.pixels, to.deviation[c], to.pixels,
                                                   settings.standard_errors, settings.most_gain);
            from.deviation[c] = 1;
        }
        rescale(i, from, to);
    };
    // The target is one frame, which stays as it is, or all, which are measured before one changes.
    auto const target = target_frame(background, settings);
    auto const falls_back = settings.fallback == without_background::all_pixels;
    std::vector<channel_statistics<Real>> own_of_all;
    std::vector<channel_statistics<Real>> whole_of_all;
    for (std::size_t i = 0; i < frames && !target; ++i) {
        own_of_all.push_back(statistics(i, false));
        if (falls_back) {
            whole_of_all.push_back(statistics(i, true));
        }
    }
    auto const to = target ? statistics(*target, false) : pooled_statistics(own_of_all, least);
    std::vector<std::size_t> skipped;
    for (std::size_t i = 0; i < frames; ++i) {
        auto const own = target ? statistics(i, false) : own_of_all[i];
        if (own.pixels >= least && to.pixels >= least) {
            if (target != i) {
                rescale_to(i, own, to);
            }
        } else if (!falls_back) {
            skipped.push_back(i);
        } else if (target != i && background.extent(1) * background.extent(2) >= 2) {
            rescale_to(i, target ? statistics(i, true) : whole_of_all[i],
                       target ? statistics(*target, true) : pooled_statistics(whole_of_all, 2));
        }
    }
    return skipped;
}

} // namespace detail

inline namespace GENRENDER_UNIT {

/// Normalises a sequence z [frames, channels, height, width] in place: each frame's statistics over its own
/// `background` [frames, height, width] become those of the settings' target over its own, by default means those of
/// frame 0. Returns the frames that were skipped for want of background (all of them if the target has none). Throws
/// shape_error if the mask does not fit, value_error for settings that say nothing.
template <class Real>
std::vector<std::size_t> normalize_latents(strided_view<Real, 4> z, strided_view<std::uint8_t const, 3> background,
                                           adain_settings<std::type_identity_t<Real>> const& settings = {}) {
    require_shape("normalize_latents", "background", background, {z.extent(0), z.extent(2), z.extent(3)});
    require_adain_settings("normalize_latents", settings);
    if (z.extent(0) == 0) {
        return {};
    }
    if (settings.statistics == adain_statistics::low_band) {
        return normalize_low_bands(z, background, settings);
    }
    std::vector<std::uint8_t> const everywhere(z.extent(2) * z.extent(3), 1);
    strided_view<std::uint8_t const, 2> const all(everywhere.data(), {z.extent(2), z.extent(3)});
    return detail::normalize_frames(
        background, settings,
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
