// SPDX-License-Identifier: MIT
// Latent normalisation that divides by nothing: the low band of the target, the high bands of each frame.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/normalization/adain_settings.hpp>
#include <genrender/normalization/low_band.hpp>
#include <genrender/normalization/normalization_target.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

/// Normalises low bands of a sequence z [frames, channels, height, width] in place: z_i <- z_i + low(reference - z_i) over
/// what is background in both, so that frame i has the reference's low band and its own high bands. The reference is the
/// settings' target, for all frames the mean at each place of those that show background there. Returns the frames that
/// were skipped for want of common background, in which `fallback` decides. Throws shape_error if `background` [frames,
/// height, width] does not fit.
template <class Real>
std::vector<std::size_t> normalize_low_bands(strided_view<Real, 4> z, strided_view<std::uint8_t const, 3> background,
                                             adain_settings<std::type_identity_t<Real>> const& settings) {
    require_shape("normalize_low_bands", "background", background, {z.extent(0), z.extent(2), z.extent(3)});
    if (z.extent(0) == 0) {
        return {};
    }
    grid_extents const grid{z.extent(2), z.extent(3)};
    auto const least = std::max<std::size_t>(settings.least_pixels, 2);
    auto const target = target_frame(background, settings);
    // The reference and where it is known: a frame, or at each place the mean of the frames with background there.
    std::vector<double> reference(z.extent(1) * grid.size());
    std::vector<double> everywhere(reference.size()); // the same over all pixels, background or not
    std::vector<std::uint8_t> known(grid.size());
    for (std::size_t e = 0; e < grid.size(); ++e) {
        double frames = 0;
        double counted = 0;
        for (auto i = target.value_or(0); i < (target ? *target + 1 : z.extent(0)); ++i) {
            auto const is_background = background(i, e / grid.width, e % grid.width) != 0;
            frames += is_background ? 1 : 0;
            counted += 1;
            for (std::size_t c = 0; c < z.extent(1); ++c) {
                auto const value = static_cast<double>(z(i, c, e / grid.width, e % grid.width));
                reference[c * grid.size() + e] += is_background ? value : 0;
                everywhere[c * grid.size() + e] += value;
            }
        }
        known[e] = frames > 0 ? 1 : 0;
        for (std::size_t c = 0; c < z.extent(1); ++c) {
            reference[c * grid.size() + e] /= std::max(frames, 1.0);
            everywhere[c * grid.size() + e] /= counted;
        }
    }
    std::vector<std::size_t> skipped;
    for (std::size_t i = 0; i < z.extent(0); ++i) {
        std::vector<std::uint8_t> common(grid.size());
        std::size_t pixels = 0;
        for (std::size_t e = 0; e < grid.size(); ++e) {
            common[e] = known[e] != 0 && background(i, e / grid.width, e % grid.width) != 0 ? 1 : 0;
            pixels += common[e];
        }
        auto const falls_back = pixels < least;
        if (falls_back && settings.fallback == without_background::skip) {
            skipped.push_back(i);
            continue;
        }
        if (target == i) {
            continue;
        }
        if (falls_back) {
            std::fill(common.begin(), common.end(), std::uint8_t{1});
        }
        low_band const low(grid, std::move(common), settings.band_levels);
        auto const& of_target = falls_back ? everywhere : reference;
        for (std::size_t c = 0; c < z.extent(1); ++c) {
            std::vector<double> apart(grid.size());
            for (std::size_t e = 0; e < grid.size(); ++e) {
                apart[e] =
                    of_target[c * grid.size() + e] - static_cast<double>(z(i, c, e / grid.width, e % grid.width));
            }
            apart = low(std::move(apart));
            for (std::size_t e = 0; e < grid.size(); ++e) {
                z(i, c, e / grid.width, e % grid.width) += static_cast<Real>(apart[e]);
            }
        }
    }
    return skipped;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
