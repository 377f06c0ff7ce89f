// SPDX-License-Identifier: MIT
// One row of pixels over time: what sticks to the screen draws straight lines, what moves draws curves.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/strided_view.hpp>

#include <cstddef>
#include <string>

namespace genrender {

/// The view [frames, channels, width] of one row of `images` [frames, channels, height, width]; copies nothing. Throws
/// value_error unless the images have that row.
template <class T>
strided_view<T, 3> time_slice(strided_view<T, 4> images, std::size_t row) {
    require_value(row < images.extent(2), "time_slice", "row", row,
                  ("a row below " + std::to_string(images.extent(2))).c_str());
    return {images.data() + static_cast<std::ptrdiff_t>(row) * images.stride(2),
            {images.extent(0), images.extent(1), images.extent(3)},
            {images.stride(0), images.stride(1), images.stride(3)}};
}

} // namespace genrender

#include <genrender/core/end_header.inl>
