// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The feature texture as the paper describes it, built texel by texel, without any code of the library's
// correspondence or blending: what the blend plan must equal.
#pragma once

#include <genrender/core/stack.hpp>
#include <genrender/maps/uv_maps.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace genrender::testing {

/// Textures of T x T texels for a number of objects, dense.
template <class Real>
struct dense_texture {
    std::size_t objects = 0;
    std::size_t T = 0;
    std::size_t channels = 0;
    std::unique_ptr<Real[]> values;   // [objects, T, T, channels]; large, and made at once without optimisation, too
    std::vector<std::uint8_t> filled; // [objects, T, T]

    dense_texture(std::size_t of_objects, std::size_t texels, std::size_t features)
        : objects(of_objects), T(texels), channels(features), values(new Real[objects * T * T * channels]()),
          filled(objects * T * T) {}

    std::size_t texel(std::uint32_t object, float u, float v) const {
        auto const index = [this](float coordinate) {
            auto const cell = static_cast<long>(std::floor(static_cast<double>(coordinate) * static_cast<double>(T)));
            return static_cast<std::size_t>(std::clamp(cell, 0L, static_cast<long>(T) - 1));
        };
        return (object * T + index(v)) * T + index(u);
    }
};

/// pi^-1: every texel takes the feature at the pixel of the frame whose UV is nearest to the texel's centre.
template <class Real>
dense_texture<Real> dense_unproject(uv_maps const& maps, std::size_t frame, strided_view<Real const, 2> F,
                                    grid_extents grid, std::size_t objects, std::size_t T) {
    dense_texture<Real> texture(objects, T, F.extent(1));
    std::vector<double> distance(texture.filled.size(), 1e30);
    auto const pixels = maps.grid();
    for (std::size_t row = 0; row < pixels.height; ++row) {
        for (std::size_t column = 0; column < pixels.width; ++column) {
            if (maps.coverage(frame, row, column) == 0) {
                continue;
            }
            auto const u = maps.uv(frame, row, column, 0);
            auto const v = maps.uv(frame, row, column, 1);
            auto const t = texture.texel(maps.object(frame, row, column), u, v);
            auto const centre_u = (static_cast<double>(t % T) + 0.5) / static_cast<double>(T);
            auto const centre_v = (static_cast<double>(t / T % T) + 0.5) / static_cast<double>(T);
            auto const away =
                std::pow(static_cast<double>(u) - centre_u, 2) + std::pow(static_cast<double>(v) - centre_v, 2);
            // Ties are decided by the lowest pixel; rounding must not decide them otherwise.
            if (away < distance[t] * (1 - 1e-9)) {
                distance[t] = away;
                auto const token = row * grid.height / pixels.height * grid.width + column * grid.width / pixels.width;
                for (std::size_t c = 0; c < F.extent(1); ++c) {
                    texture.values[t * texture.channels + c] = F(token, c);
                }
                texture.filled[t] = 1;
            }
        }
    }
    return texture;
}

/// The unified texture: the mean of the average over the frames that see a texel, and of the texture inpainted in their
/// order.
template <class Real>
dense_texture<Real> dense_blend(std::vector<dense_texture<Real>> const& frames, Real first_fill_share = Real(0.5)) {
    dense_texture<Real> unified(frames.front().objects, frames.front().T, frames.front().channels);
    for (std::size_t t = 0; t < unified.filled.size(); ++t) {
        for (std::size_t c = 0; c < unified.channels; ++c) {
            Real sum = 0;
            Real inpainted = 0;
            std::size_t seen = 0;
            for (auto const& frame : frames) {
                if (frame.filled[t] != 0) {
                    auto const value = frame.values[t * unified.channels + c];
                    inpainted = seen == 0 ? value : inpainted;
                    sum += value;
                    ++seen;
                }
            }
            unified.filled[t] = seen > 0 ? 1 : 0;
            unified.values[t * unified.channels + c] =
                seen > 0 ? first_fill_share * inpainted + (1 - first_fill_share) * sum / static_cast<Real>(seen)
                         : Real{0};
        }
    }
    return unified;
}

/// The texel that a token reads: of the object with most pixels in its cell, the pixel nearest to the cell's centre.
inline std::optional<std::size_t> dense_texel_of(uv_maps const& maps, std::size_t frame, grid_extents grid,
                                                 std::size_t token, std::size_t objects, std::size_t T) {
    auto const height = maps.grid().height / grid.height;
    auto const width = maps.grid().width / grid.width;
    auto const top = token / grid.width * height;
    auto const left = token % grid.width * width;
    std::vector<std::size_t> owned(objects);
    std::size_t background = 0;
    for (std::size_t p = 0; p < height * width; ++p) {
        auto const row = top + p / width;
        auto const column = left + p % width;
        if (maps.coverage(frame, row, column) != 0) {
            ++owned[maps.object(frame, row, column)];
        } else {
            ++background;
        }
    }
    if (2 * background > height * width) {
        return std::nullopt;
    }
    auto const owner = static_cast<std::uint32_t>(std::max_element(owned.begin(), owned.end()) - owned.begin());
    std::optional<std::size_t> best;
    double nearest = 1e30;
    for (std::size_t p = 0; p < height * width; ++p) {
        auto const row = top + p / width;
        auto const column = left + p % width;
        auto const down = static_cast<double>(p / width) + 0.5 - static_cast<double>(height) / 2;
        auto const right = static_cast<double>(p % width) + 0.5 - static_cast<double>(width) / 2;
        if (maps.coverage(frame, row, column) != 0 && maps.object(frame, row, column) == owner &&
            down * down + right * right < nearest) {
            nearest = down * down + right * right;
            best = dense_texture<float>(objects, T, 1)
                       .texel(owner, maps.uv(frame, row, column, 0), maps.uv(frame, row, column, 1));
        }
    }
    return best;
}

} // namespace genrender::testing
