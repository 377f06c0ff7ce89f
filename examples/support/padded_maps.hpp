// SPDX-License-Identifier: MIT
// Maps and pictures with more pixels, or fewer, on the right and below.
#pragma once

#include <genrender/core/index.hpp>
#include <genrender/core/tensor.hpp>
#include <genrender/scene/rasterizer.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace genrender::examples {

namespace detail {

/// The same values with sides of these extents at the axes from `axis` on; zero where there were none.
template <class Tensor>
Tensor with_sides(Tensor const& from, std::size_t axis, grid_extents to) {
    auto shape = from.shape();
    std::size_t planes = 1;
    std::size_t values = 1;
    for (std::size_t i = 0; i < shape.size(); ++i) {
        planes *= i < axis ? shape[i] : 1;
        values *= i > axis + 1 ? shape[i] : 1;
    }
    grid_extents const old{shape[axis], shape[axis + 1]};
    shape[axis] = to.height;
    shape[axis + 1] = to.width;
    auto result = Tensor::from_shape(shape);
    result.fill(0);
    auto const kept = std::min(old.width, to.width) * values;
    for (std::size_t plane = 0; plane < planes; ++plane) {
        for (std::size_t row = 0; row < std::min(old.height, to.height); ++row) {
            std::copy_n(from.data() + (plane * old.height + row) * old.width * values, kept,
                        result.data() + (plane * to.height + row) * to.width * values);
        }
    }
    return result;
}

} // namespace detail

/// The maps in these extents: what is more shows nothing, what is less is cut.
inline rendered_guidance with_extents(rendered_guidance guidance, grid_extents to) {
    if (guidance.uv.grid() == to) {
        return guidance;
    }
    guidance.uv.uv = detail::with_sides(guidance.uv.uv, 1, to);
    guidance.uv.object = detail::with_sides(guidance.uv.object, 1, to);
    guidance.uv.coverage = detail::with_sides(guidance.uv.coverage, 1, to);
    guidance.depth.depth = detail::with_sides(guidance.depth.depth, 1, to);
    guidance.depth.coverage = detail::with_sides(guidance.depth.coverage, 1, to);
    if (guidance.position.shape()[0] > 0) {
        guidance.position = detail::with_sides(guidance.position, 1, to);
    }
    return guidance;
}

/// Pictures [frames, channels, height, width] in these extents.
inline tensor<float, 4> with_extents(tensor<float, 4> pictures, grid_extents to) {
    auto const& shape = pictures.shape();
    return grid_extents{shape[2], shape[3]} == to ? std::move(pictures) : detail::with_sides(pictures, 2, to);
}

} // namespace genrender::examples
