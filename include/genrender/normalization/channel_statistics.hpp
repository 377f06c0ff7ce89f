// SPDX-License-Identifier: MIT
// [GR sec. 3.4] Mean and deviation of each channel of a frame's latents over the background.
#pragma once

#include <genrender/core/strided_view.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace genrender {

/// Mean and standard deviation per channel, and the number of pixels they come from.
template <class Real>
struct channel_statistics {
    std::vector<Real> mean;
    std::vector<Real> deviation;
    std::size_t pixels = 0;
};

/// Statistics of z [channels, height, width] over the pixels whose `mask` [height, width] is not 0: mean and
/// sqrt(unbiased variance + epsilon). With fewer than 2 pixels there is no variance: `pixels` says so and means and
/// deviations are 0 and 1. Throws shape_error if the mask does not fit.
template <class Real>
channel_statistics<Real> masked_statistics(strided_view<Real const, 3> z, strided_view<std::uint8_t const, 2> mask,
                                           std::type_identity_t<Real> epsilon = Real(1e-5)) {
    auto const channels = z.extent(0);
    require_shape("masked_statistics", "mask", mask, {z.extent(1), z.extent(2)});
    channel_statistics<Real> result{std::vector<Real>(channels, Real{0}), std::vector<Real>(channels, Real{1}), 0};
    auto const for_each_pixel = [&](auto&& visit) {
        for (std::size_t row = 0; row < z.extent(1); ++row) {
            for (std::size_t column = 0; column < z.extent(2); ++column) {
                if (mask(row, column) != 0) {
                    visit(row, column);
                }
            }
        }
    };
    for_each_pixel([&](std::size_t, std::size_t) { ++result.pixels; });
    if (result.pixels < 2) {
        return result;
    }
    auto const n = static_cast<double>(result.pixels);
    for (std::size_t c = 0; c < channels; ++c) {
        // Two passes in double: the variance of a nearly constant background must not drown in its mean.
        double sum = 0;
        for_each_pixel([&](std::size_t row, std::size_t column) { sum += static_cast<double>(z(c, row, column)); });
        auto const mean = sum / n;
        double squares = 0;
        for_each_pixel([&](std::size_t row, std::size_t column) {
            auto const difference = static_cast<double>(z(c, row, column)) - mean;
            squares += difference * difference;
        });
        result.mean[c] = static_cast<Real>(mean);
        result.deviation[c] = static_cast<Real>(std::sqrt(squares / (n - 1) + static_cast<double>(epsilon)));
    }
    return result;
}

} // namespace genrender
