// SPDX-License-Identifier: MIT
// How steep colours are within objects, silhouettes left out.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/strided_view.hpp>
#include <genrender/evaluation/pixel_objects.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace genrender {

/// Mean length of the gradient, over all pixels that belong to one of the objects that `counts` names together with
/// their right and lower neighbours; the squared differences to these two are averaged over channels before the root.
/// In units of the images [frames, channels, height, width] a pixel. None if there is no such pixel. Noise is steep as
/// well: more than that of a render is no merit. Throws shape_error if images and objects differ.
template <class Real, object_predicate Counts = every_object>
std::optional<double> sharpness(strided_view<Real, 4> images, pixel_objects const& objects, Counts const& counts = {}) {
    require_images_of("sharpness", images, objects);
    auto const channels = images.extent(1);
    double sum = 0;
    std::size_t terms = 0;
    for (std::uint32_t i = 0; i < images.extent(0); ++i) {
        auto const image = images[i];
        for (std::uint32_t row = 0; row + 1 < images.extent(2); ++row) {
            for (std::uint32_t column = 0; column + 1 < images.extent(3); ++column) {
                auto const object = objects.object_at({i}, {row, column});
                if (!object || !counts(*object) || objects.object_at({i}, {row, column + 1}) != object ||
                    objects.object_at({i}, {row + 1, column}) != object || channels == 0) {
                    continue;
                }
                double squares = 0;
                for (std::size_t c = 0; c < channels; ++c) {
                    auto const here = static_cast<double>(image(c, row, column));
                    auto const right = static_cast<double>(image(c, row, column + 1)) - here;
                    auto const down = static_cast<double>(image(c, row + 1, column)) - here;
                    squares += right * right + down * down;
                }
                sum += std::sqrt(squares / static_cast<double>(channels));
                ++terms;
            }
        }
    }
    return terms > 0 ? std::optional(sum / static_cast<double>(terms)) : std::nullopt;
}

} // namespace genrender

#include <genrender/core/end_header.inl>
