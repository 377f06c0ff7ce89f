// SPDX-License-Identifier: MIT
// [GR sec. 3.4] What changes between consecutive frames and should not: the background, and the colours as a whole.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/evaluation/pixel_objects.hpp>
#include <genrender/maps/background_mask.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace genrender {

/// Root of the mean squared difference, over all channels, between consecutive frames at the pixels that are background
/// in both, and so in every pixel up to `margin` rows and columns away, in the units of the images [frames, channels,
/// height, width]. With a margin what a decoder mixes of objects into their surroundings is left out. None if there is no
/// such pixel. Throws shape_error if images and objects differ.
template <class Real>
std::optional<double> background_flicker(strided_view<Real, 4> images, pixel_objects const& objects,
                                         std::size_t margin = 0) {
    require_images_of("background_flicker", images, objects);
    auto background = tensor<std::uint8_t, 3>::from_shape({images.extent(0), images.extent(2), images.extent(3)});
    for (std::uint32_t i = 0; i < images.extent(0); ++i) {
        for (std::uint32_t row = 0; row < images.extent(2); ++row) {
            for (std::uint32_t column = 0; column < images.extent(3); ++column) {
                background(i, row, column) = objects.is_background({i}, {row, column}) ? 1 : 0;
            }
        }
    }
    auto const open = open_background(to_view(std::as_const(background)), margin);
    double squares = 0;
    std::size_t count = 0;
    for (std::uint32_t i = 1; i < images.extent(0); ++i) {
        for (std::size_t row = 0; row < images.extent(2); ++row) {
            for (std::size_t column = 0; column < images.extent(3); ++column) {
                if (open(i - 1, row, column) == 0 || open(i, row, column) == 0) {
                    continue;
                }
                for (std::size_t c = 0; c < images.extent(1); ++c) {
                    auto const change = static_cast<double>(images(i, c, row, column)) -
                                        static_cast<double>(images(i - 1, c, row, column));
                    squares += change * change;
                    ++count;
                }
            }
        }
    }
    return count > 0 ? std::optional(std::sqrt(squares / static_cast<double>(count))) : std::nullopt;
}

/// How much the colours of whole frames change from one to the next.
struct colour_change {
    double mean = 0;      ///< root of the mean squared change of the frames' mean colours
    double deviation = 0; ///< the same of the standard deviations of their colours
};

/// The flicker that latent normalisation is for, over frames and channels, in the units of the images [frames,
/// channels, height, width]. Motion changes the colours of a frame as well, so it is to be read beside that of renders.
/// None with fewer than two frames or no pixels.
template <class Real>
std::optional<colour_change> colour_flicker(strided_view<Real, 4> images) {
    auto const [frames, channels, height, width] = images.extents();
    if (frames < 2 || channels * height * width == 0) {
        return std::nullopt;
    }
    struct moments {
        double mean = 0;
        double deviation = 0;
    };
    auto const moments_of = [&images](std::size_t i, std::size_t c) {
        auto const n = static_cast<double>(images.extent(2) * images.extent(3));
        auto const image = images[i][c];
        auto const sum = [&image](auto&& term) {
            double total = 0;
            for (std::size_t row = 0; row < image.extent(0); ++row) {
                for (std::size_t column = 0; column < image.extent(1); ++column) {
                    total += term(static_cast<double>(image(row, column)));
                }
            }
            return total;
        };
        auto const mean = sum([](double x) { return x; }) / n;
        return moments{mean, std::sqrt(sum([mean](double x) { return (x - mean) * (x - mean); }) / n)};
    };
    colour_change squares;
    for (std::size_t c = 0; c < channels; ++c) {
        auto before = moments_of(0, c);
        for (std::size_t i = 1; i < frames; ++i) {
            auto const now = moments_of(i, c);
            squares.mean += (now.mean - before.mean) * (now.mean - before.mean);
            squares.deviation += (now.deviation - before.deviation) * (now.deviation - before.deviation);
            before = now;
        }
    }
    auto const count = static_cast<double>((frames - 1) * channels);
    return colour_change{std::sqrt(squares.mean / count), std::sqrt(squares.deviation / count)};
}

} // namespace genrender

#include <genrender/core/end_header.inl>
