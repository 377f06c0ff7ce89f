// SPDX-License-Identifier: MIT
// [GR sec. 4] Pixels of two frames that show one surface point to a fraction of a pixel: what errors are measured at.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/evaluation/pixel_objects.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// A surface point under the middle of a pixel, and how far the next pixels lie from it on the texture.
struct seen_point {
    object_index object;           ///< what the pixel shows
    std::array<float, 2> uv{};     ///< texture coordinates
    std::array<float, 2> across{}; ///< change of uv from the pixel to the one on its right
    std::array<float, 2> down{};   ///< change of uv from the pixel to the one below

    /// Where `other` lies from the pixel's middle, in pixels along the axis on which it is further; both of one object.
    double offset_of(seen_point const& other) const {
        auto const du = double{other.uv[0]} - double{uv[0]};
        auto const dv = double{other.uv[1]} - double{uv[1]};
        auto const right = du * double{down[1]} - dv * double{down[0]};
        auto const below = dv * double{across[0]} - du * double{across[1]};
        return std::max(std::abs(right), std::abs(below)) / std::abs(area());
    }

    /// Area of the pixel on the texture, negative where the texture is seen mirrored.
    double area() const { return double{across[0]} * double{down[1]} - double{across[1]} * double{down[0]}; }
};

/// A model of correspondence_map for measuring images rather than for making them. texel_grid gives every pixel some
/// partner, up to half a pixel and a texel away, so that two perfect renders differ by their own texture's slope; here
/// two pixels correspond only if each shows the other's surface point at most `reach` pixels from its own middle. That
/// relation is symmetric, and pairs are visible in both frames because both are read off what was rendered. Pixels on
/// silhouettes show no point, nor do those that span more than a quarter of a texture.
class pixel_correspondence {
public:
    using point_type = seen_point; ///< a point of a surface, as a pixel shows it

    /// Pixels of images of `grid` by UV maps of the same or a finer resolution; `reach` in pixels, in (0, 0.5]: a
    /// smaller one leaves fewer, closer pairs. Throws value_error if the grid does not divide the maps, UVs are not
    /// finite, or reach is out of range.
    pixel_correspondence(uv_maps_view const& maps, grid_extents grid, double reach = 0.25, any_loop const& loop = {})
        : objects_(maps, grid), reach_(reach), frames_(maps.frame_count()) {
        require_value(reach > 0 && reach <= 0.5, "pixel_correspondence", "reach", reach, "a number in (0, 0.5]");
        loop(frames_.size(), [&](std::size_t i) { index(maps, {static_cast<std::uint32_t>(i)}); });
    }

    /// Number of frames.
    std::size_t frame_count() const { return frames_.size(); }
    /// Height and width of a frame in pixels.
    grid_extents grid() const { return objects_.grid(); }
    /// What each pixel shows.
    pixel_objects const& objects() const { return objects_; }

    /// The surface point under the middle of the pixel.
    std::optional<point_type> point_at(frame_index frame, token_index token) const {
        return frames_[frame.value].points[token.value];
    }

    /// The pixel whose middle shows the point: of those within reach the closest.
    std::optional<token_index> token_at(frame_index frame, point_type const& point) const {
        auto const& seen = frames_[frame.value];
        entry const place{bin_key(point.object, bin(point.uv[0]), bin(point.uv[1])), 0};
        std::optional<token_index> closest;
        auto closest_offset = reach_;
        for (auto e = std::lower_bound(seen.bins.begin(), seen.bins.end(), place);
             e != seen.bins.end() && e->first == place.first; ++e) {
            auto const& other = *seen.points[e->second];
            auto const offset = std::max(other.offset_of(point), point.offset_of(other));
            if (closest ? offset < closest_offset : offset <= reach_) {
                closest = token_index{e->second};
                closest_offset = offset;
            }
        }
        return closest;
    }

private:
    using entry = std::pair<std::uint64_t, std::uint32_t>; // key of a bin, pixel

    struct seen_frame {
        std::vector<std::optional<seen_point>> points; // [height, width]
        std::vector<entry> bins;                       // sorted; a pixel is in every bin that its reach touches
    };

    static constexpr std::uint32_t bins_a_side = 128;
    static constexpr double greatest_span = 0.25;

    static std::uint32_t bin(double coordinate) {
        return static_cast<std::uint32_t>(std::clamp(std::floor(coordinate * bins_a_side), 0.0, bins_a_side - 1.0));
    }
    static std::uint64_t bin_key(object_index object, std::uint32_t column, std::uint32_t row) {
        return (std::uint64_t{object.value} * bins_a_side + row) * bins_a_side + column;
    }

    void index(uv_maps_view const& maps, frame_index i) {
        auto& seen = frames_[i.value];
        auto const grid = objects_.grid();
        seen.points.resize(grid.size());
        for (std::uint32_t p = 0; p < grid.size(); ++p) {
            auto const point = find_point(maps, i, p);
            if (!point) {
                continue;
            }
            seen.points[p] = point;
            auto const reach_u = reach_ * (std::abs(double{point->across[0]}) + std::abs(double{point->down[0]}));
            auto const reach_v = reach_ * (std::abs(double{point->across[1]}) + std::abs(double{point->down[1]}));
            for (auto row = bin(point->uv[1] - reach_v); row <= bin(point->uv[1] + reach_v); ++row) {
                for (auto column = bin(point->uv[0] - reach_u); column <= bin(point->uv[0] + reach_u); ++column) {
                    seen.bins.emplace_back(bin_key(point->object, column, row), p);
                }
            }
        }
        std::sort(seen.bins.begin(), seen.bins.end());
    }

    std::optional<seen_point> find_point(uv_maps_view const& maps, frame_index i, std::uint32_t token) const {
        auto const grid = objects_.grid();
        grid_extents const cell{maps.grid().height / grid.height, maps.grid().width / grid.width};
        pixel const p{static_cast<std::uint32_t>(token / grid.width), static_cast<std::uint32_t>(token % grid.width)};
        auto const object = objects_.object_at(i, p);
        if (!object) {
            return std::nullopt;
        }
        // Where a cell has no map pixel in its middle, the one left and above of it speaks in every frame alike.
        pixel const at{static_cast<std::uint32_t>(p.row * cell.height + (cell.height - 1) / 2),
                       static_cast<std::uint32_t>(p.column * cell.width + (cell.width - 1) / 2)};
        auto const across = slope(maps, i, at, {0, 1});
        auto const down = slope(maps, i, at, {1, 0});
        if (!across || !down) {
            return std::nullopt;
        }
        auto const scaled = [](std::array<float, 2> const& step, std::size_t count) {
            return std::array{step[0] * static_cast<float>(count), step[1] * static_cast<float>(count)};
        };
        seen_point const point{*object, maps.point_at(i, at), scaled(*across, cell.width), scaled(*down, cell.height)};
        auto const lengths = length(point.across) * length(point.down);
        // Less than a degree between the axes leaves no direction to measure along.
        auto const is_flat = !(std::abs(point.area()) > 0.02 * lengths);
        auto const span = std::max(length(point.across), length(point.down));
        return is_flat || span > greatest_span ? std::nullopt : std::optional(point);
    }

    /// Change of uv from one map pixel to the next along `step`: of the two sides the smaller one, since a seam or an
    /// edge of the surface shows as a leap.
    static std::optional<std::array<float, 2>> slope(uv_maps_view const& maps, frame_index i, pixel at, pixel step) {
        auto const object = maps.object_at(i, at);
        auto const here = finite_uv(maps, i, at);
        std::optional<std::array<float, 2>> smaller;
        auto const offer = [&](pixel there, float sign) {
            // Unsigned numbers wrap above every extent where the neighbour lies left of or above the map.
            auto const is_inside = there.row < maps.grid().height && there.column < maps.grid().width;
            if (is_inside && maps.is_covered(i, there) && maps.object_at(i, there) == object) {
                auto const uv = finite_uv(maps, i, there);
                std::array const change{sign * (uv[0] - here[0]), sign * (uv[1] - here[1])};
                smaller = smaller && length(*smaller) <= length(change) ? smaller : std::optional(change);
            }
        };
        offer({at.row + step.row, at.column + step.column}, 1);
        offer({at.row - step.row, at.column - step.column}, -1);
        return smaller;
    }

    static std::array<float, 2> finite_uv(uv_maps_view const& maps, frame_index i, pixel at) {
        auto const uv = maps.point_at(i, at);
        for (auto const coordinate : uv) {
            require_value(is_finite(coordinate), "pixel_correspondence", "uv", coordinate,
                          "finite texture coordinates");
        }
        return uv;
    }

    static double length(std::array<float, 2> const& x) { return std::hypot(double{x[0]}, double{x[1]}); }

    pixel_objects objects_;
    double reach_;
    std::vector<seen_frame> frames_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
