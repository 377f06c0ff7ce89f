// SPDX-License-Identifier: MIT
// How much colours vary within objects: small where a method blurs, so errors are read against it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>
#include <genrender/evaluation/pixel_objects.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace genrender {

/// Standard deviation of the colours of an object in a frame, the root of the mean variance of its channels, averaged
/// over frames and the objects that `counts` names; in the units of the images [frames, channels, height, width]. An
/// object counts in frames where it fills at least 16 pixels: the deviation of a few says nothing. None if there is no
/// such object. Throws shape_error if images and objects differ.
template <class Real, object_predicate Counts = every_object>
std::optional<double> contrast(strided_view<Real, 4> images, pixel_objects const& objects, Counts const& counts = {}) {
    constexpr std::size_t fewest_pixels = 16;
    require_images_of("contrast", images, objects);
    double sum = 0;
    std::size_t terms = 0;
    for (std::uint32_t i = 0; i < images.extent(0); ++i) {
        std::map<object_index, std::vector<pixel>> pixels;
        for (std::uint32_t row = 0; row < images.extent(2); ++row) {
            for (std::uint32_t column = 0; column < images.extent(3); ++column) {
                auto const object = objects.object_at({i}, {row, column});
                if (object && counts(*object)) {
                    pixels[*object].push_back({row, column});
                }
            }
        }
        for (auto const& [object, filled] : pixels) {
            if (filled.size() < fewest_pixels || images.extent(1) == 0) {
                continue;
            }
            auto const n = static_cast<double>(filled.size());
            double squares = 0;
            for (std::size_t c = 0; c < images.extent(1); ++c) {
                // Two passes: the variance of a nearly even object must not drown in its mean.
                double mean = 0;
                for (auto const p : filled) {
                    mean += static_cast<double>(images(i, c, p.row, p.column)) / n;
                }
                for (auto const p : filled) {
                    auto const centred = static_cast<double>(images(i, c, p.row, p.column)) - mean;
                    squares += centred * centred;
                }
            }
            sum += std::sqrt(squares / (n * static_cast<double>(images.extent(1))));
            ++terms;
        }
    }
    return terms > 0 ? std::optional(sum / static_cast<double>(terms)) : std::nullopt;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
