// SPDX-License-Identifier: MIT
// [GR sec. 3.3] UV noise that stays white: every latent pixel sums the noise of the part of the surface that it sees.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/random.hpp>
#include <genrender/core/strided_view.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/maps/cell_extents.hpp>
#include <genrender/noise/background_noise.hpp>
#include <genrender/noise/noise_tree.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace genrender {

/// What the latent pixels of one frame look at: cells of the noise of each object and of the surroundings.
template <std::size_t D>
struct noise_looks {
    std::map<object_index, std::vector<noise_request<D>>> objects; ///< what latent pixels look at on each object
    std::vector<noise_request<3>> surroundings;                    ///< under background_noise::environment
    std::vector<double> background; ///< share of each latent pixel that shows no object, in [0, 1]
};

/// Where the points lie that a latent pixel looks at: at least 4 x 4 of them, in the maps' pixels or between them.
struct noise_sampling {
    /// Least number of points along the side of a latent pixel.
    static constexpr std::size_t points_per_side = 4;

    std::size_t stride = 1; ///< pixels of the map from one looked at to the next
    std::size_t looked = 1; ///< pixels looked at along the side of a latent pixel
    std::size_t parts = 1;  ///< parts of each along that side, at least

    /// For latent pixels that are squares of `cell_side` pixels of the maps.
    explicit noise_sampling(std::size_t cell_side)
        : stride(std::max<std::size_t>(1, cell_side / points_per_side)), looked((cell_side + stride - 1) / stride),
          parts((points_per_side + looked - 1) / looked) {}
};

namespace detail {

/// Adds the parts of one pixel of the map: about square on the surface, each looking at a cell as wide as the parts lie
/// apart, so that no cell is missed. `share` is the pixel's of the latent pixel.
template <std::size_t D>
void add_looks(std::vector<noise_request<D>>& requests, std::array<float, D> const& middle,
               surface_footprint<D> const& footprint, noise_sampling const& down, noise_sampling const& right,
               std::uint32_t latent_pixel, double share) {
    // More parts along the side on which the surface runs away from the eye.
    auto const area = footprint.area();
    auto const parts_along = [area](std::size_t least, std::array<float, D> const& side) {
        auto const stretch = std::clamp(surface_footprint<D>::dot(side, side) / area, 1.0, 8.0);
        return static_cast<std::size_t>(std::ceil(static_cast<double>(least) * stretch - 1e-9));
    };
    auto const rows = parts_along(down.parts, footprint.down);
    auto const columns = parts_along(right.parts, footprint.across);
    auto const count = static_cast<double>(rows * columns);
    auto const level =
        noise_tree<D>::level_of(std::sqrt(area * static_cast<double>(down.stride * right.stride) / count));
    auto const place_along = [](std::size_t part, std::size_t parts, std::size_t stride) {
        return ((static_cast<double>(part) + 0.5) / static_cast<double>(parts) - 0.5) * static_cast<double>(stride);
    };
    for (std::size_t row = 0; row < rows; ++row) {
        auto const below = place_along(row, rows, down.stride);
        for (std::size_t column = 0; column < columns; ++column) {
            auto const beside = place_along(column, columns, right.stride);
            std::array<double, D> point{};
            for (std::size_t d = 0; d < D; ++d) {
                point[d] = double{middle[d]} + below * double{footprint.down[d]} + beside * double{footprint.across[d]};
            }
            requests.push_back({noise_tree<D>::place_of(point), level, latent_pixel, share / count});
        }
    }
}

/// Adds a pixel whose footprint nobody knows: its own point of the surface and nothing around it.
template <std::size_t D>
void add_look(std::vector<noise_request<D>>& requests, std::array<float, D> const& middle, std::uint32_t latent_pixel,
              double share) {
    std::array<double, D> point{};
    std::copy(middle.begin(), middle.end(), point.begin());
    requests.push_back({noise_tree<D>::place_of(point), noise_tree<D>::deepest, latent_pixel, share});
}

} // namespace detail

/// What the latent pixels of frame i look at, by the footprints of the maps' pixels. Throws value_error if the grid
/// does not divide the maps or a coordinate is not finite or beyond noise_tree's range.
template <canonical_maps Maps>
noise_looks<Maps::dimensions> look_at_noise(Maps const& maps, frame_index i, grid_extents grid,
                                            background_noise background, environment_rays const& rays) {
    auto const cell = cell_extents("surface_noise", maps.grid(), grid);
    noise_sampling const down(cell.height);
    noise_sampling const right(cell.width);
    noise_looks<Maps::dimensions> looks;
    looks.background.assign(grid.size(), 0);
    auto const share = 1 / static_cast<double>(down.looked * right.looked);
    for (std::uint32_t t = 0; t < grid.size(); ++t) {
        auto const top = t / grid.width * cell.height;
        auto const left = t % grid.width * cell.width;
        for (auto row = top + down.stride / 2; row < top + cell.height; row += down.stride) {
            for (auto column = left + right.stride / 2; column < left + cell.width; column += right.stride) {
                pixel const p{static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column)};
                if (maps.is_covered(i, p)) {
                    auto& requests = looks.objects[maps.object_at(i, p)];
                    if (auto const footprint = footprint_at(maps, i, p)) {
                        detail::add_looks(requests, maps.point_at(i, p), *footprint, down, right, t, share);
                    } else {
                        detail::add_look(requests, maps.point_at(i, p), t, share);
                    }
                    continue;
                }
                looks.background[t] += share;
                if (background == background_noise::environment) {
                    auto const [direction, footprint] = rays.at(i, p);
                    detail::add_looks(looks.surroundings, direction, footprint, down, right, t, share);
                }
            }
        }
    }
    return looks;
}

/// Writes noise of N(0, 1) into z [channels, height, width] for frame i: white within the frame whatever the maps show,
/// and between frames as correlated as the surfaces under two latent pixels overlap. Each frame depends on its own
/// maps, the seed and the diffusion step alone, so a sampler that adds noise calls it again with another step. Throws
/// as look_at_noise does.
template <class Real, canonical_maps Maps>
void surface_noise(strided_view<Real, 3> z, Maps const& maps, frame_index i, std::uint64_t seed,
                   background_noise background = background_noise::fixed, environment_rays const& rays = {},
                   std::uint32_t step = 0) {
    grid_extents const grid{z.extent(1), z.extent(2)};
    auto const channels = z.extent(0);
    auto looks = look_at_noise(maps, i, grid, background, rays);
    std::vector<double> sums(grid.size() * channels);
    for (auto& [object, requests] : looks.objects) {
        noise_tree<Maps::dimensions>(seed, random_stream::surface_noise, object, step).add(sums, channels, requests);
    }
    noise_tree<3>(seed, random_stream::environment_noise, {}, step).add(sums, channels, looks.surroundings);
    for (std::uint32_t t = 0; t < grid.size(); ++t) {
        auto const of_screen = background == background_noise::environment ? 0 : std::sqrt(looks.background[t]);
        for (std::uint32_t c = 0; c < channels; ++c) {
            auto value = sums[t * channels + c];
            if (of_screen > 0) {
                value += of_screen * screen_noise(seed, background, i, step, t, c);
            }
            z(c, t / grid.width, t % grid.width) = static_cast<Real>(value);
        }
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
