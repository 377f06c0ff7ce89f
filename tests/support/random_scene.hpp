// SPDX-License-Identifier: MIT
// UV maps of made-up scenes: rectangles that move, overlap and leave the frame, drawn without a rasteriser.
#pragma once

#include <genrender/core/random.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <cstddef>
#include <cstdint>

namespace genrender::testing {

/// `objects` textured rectangles of random size, place and motion; later ones hide earlier ones. About a third of the
/// pixels stay background. The texture of a rectangle covers [0, 1]^2 and moves with it, with a little zoom.
inline uv_maps random_scene(std::uint64_t seed, std::size_t frames, grid_extents grid, std::size_t objects) {
    uv_maps maps(frames, grid);
    auto const random = [&](std::uint32_t object, std::uint32_t what) {
        return uniform_value(seed, random_stream::test, {object, what, 0});
    };
    for (std::size_t i = 0; i < frames; ++i) {
        for (std::uint32_t object = 0; object < objects; ++object) {
            auto const time = static_cast<double>(i);
            auto const zoom = 1 + 0.08 * time * (random(object, 5) - 0.5);
            auto const width = (0.25 + 0.5 * random(object, 0)) * zoom;
            auto const height = (0.25 + 0.5 * random(object, 1)) * zoom;
            auto const left = random(object, 2) * 0.8 - 0.1 + time * 0.07 * (random(object, 3) - 0.5);
            auto const top = random(object, 4) * 0.8 - 0.1 + time * 0.07 * (random(object, 6) - 0.5);
            for (std::size_t row = 0; row < grid.height; ++row) {
                for (std::size_t column = 0; column < grid.width; ++column) {
                    auto const u =
                        ((static_cast<double>(column) + 0.5) / static_cast<double>(grid.width) - left) / width;
                    auto const v = ((static_cast<double>(row) + 0.5) / static_cast<double>(grid.height) - top) / height;
                    if (u >= 0 && u < 1 && v >= 0 && v < 1) {
                        maps.uv(i, row, column, 0) = static_cast<float>(u);
                        maps.uv(i, row, column, 1) = static_cast<float>(v);
                        maps.object(i, row, column) = object;
                        maps.coverage(i, row, column) = 1;
                    }
                }
            }
        }
    }
    return maps;
}

} // namespace genrender::testing
