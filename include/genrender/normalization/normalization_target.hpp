// SPDX-License-Identifier: MIT
// Whose statistics latent normalisation gives to all frames: those of one of them, or of all together.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>
#include <genrender/normalization/adain_settings.hpp>
#include <genrender/normalization/channel_statistics.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace genrender {

/// The frame whose statistics those of all frames become, by their `background` [frames, height, width]; none for those of
/// all together. There is at least one frame.
template <class Real>
std::optional<std::size_t> target_frame(strided_view<std::uint8_t const, 3> background,
                                        adain_settings<Real> const& settings) {
    if (settings.target != adain_target::first_with_background) {
        return settings.target == adain_target::first_frame ? std::optional<std::size_t>(0) : std::nullopt;
    }
    std::size_t most = 0;
    std::size_t most_pixels = 0;
    for (std::size_t i = 0; i < background.extent(0); ++i) {
        std::size_t pixels = 0;
        for (std::size_t row = 0; row < background.extent(1); ++row) {
            for (std::size_t column = 0; column < background.extent(2); ++column) {
                pixels += background(i, row, column) != 0 ? 1U : 0U;
            }
        }
        auto const enough = static_cast<double>(settings.enough_background) *
                            static_cast<double>(background.extent(1) * background.extent(2));
        if (pixels >= std::max<std::size_t>(settings.least_pixels, 2) && static_cast<double>(pixels) >= enough) {
            return i;
        }
        if (pixels > most_pixels) {
            most = i;
            most_pixels = pixels;
        }
    }
    return most;
}

/// Statistics of the pixels of several frames together, of those with `least` of them or more: the mean of all, and the
/// deviation within frames, sqrt(sum (n_i - 1) d_i^2 / sum (n_i - 1)).
template <class Real>
channel_statistics<Real> pooled_statistics(std::vector<channel_statistics<Real>> const& frames, std::size_t least) {
    auto const channels = frames.empty() ? 0 : frames.front().mean.size();
    channel_statistics<Real> all{std::vector<Real>(channels, Real{0}), std::vector<Real>(channels, Real{1}), 0};
    for (std::size_t c = 0; c < channels; ++c) {
        double pixels = 0;
        double sum = 0;
        double squares = 0;
        double freedom = 0;
        for (auto const& one : frames) {
            if (one.pixels >= least) {
                auto const n = static_cast<double>(one.pixels);
                pixels += n;
                sum += n * static_cast<double>(one.mean[c]);
                squares += (n - 1) * static_cast<double>(one.deviation[c]) * static_cast<double>(one.deviation[c]);
                freedom += n - 1;
            }
        }
        if (pixels > 0) {
            all.mean[c] = static_cast<Real>(sum / pixels);
            all.deviation[c] = static_cast<Real>(std::sqrt(squares / freedom));
        }
        all.pixels = static_cast<std::size_t>(pixels);
    }
    return all;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
