// SPDX-License-Identifier: MIT
// How little pixels change from one frame to the next: VBench's figure of temporal flickering.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>

#include <cmath>
#include <cstddef>
#include <optional>

namespace genrender {

/// 1 - the mean of |x_t - x_{t-1}| over all frames, channels and pixels of `images` [frames, channels, height, width] in
/// [0, 1]: VBench's temporal flickering (Huang et al. 2024: (255 - mean absolute difference) / 255), 1 where nothing
/// changes. Motion changes pixels as well, so it is to be read beside that of renders. None with fewer than two frames or
/// no pixels.
template <class Real>
std::optional<double> temporal_flicker(strided_view<Real, 4> images) {
    auto const [frames, channels, height, width] = images.extents();
    if (frames < 2 || channels * height * width == 0) {
        return std::nullopt;
    }
    double sum = 0;
    for (std::size_t t = 1; t < frames; ++t) {
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t row = 0; row < height; ++row) {
                for (std::size_t column = 0; column < width; ++column) {
                    sum += std::abs(static_cast<double>(images(t, c, row, column)) -
                                    static_cast<double>(images(t - 1, c, row, column)));
                }
            }
        }
    }
    return 1 - sum / static_cast<double>((frames - 1) * channels * height * width);
}

} // namespace genrender

#include <genrender/core/end_header.inl>
