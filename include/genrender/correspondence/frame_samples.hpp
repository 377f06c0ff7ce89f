// SPDX-License-Identifier: MIT
// Samples of a frame's maps, which tell which of its tokens show a surface point.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/correspondence/object_samples.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/maps/cell_extents.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

namespace detail {

/// Throws value_error of `function` unless the canonical coordinates of a point are finite.
template <std::size_t D>
void require_finite_point(char const* function, std::array<float, D> const& point) {
    for (auto const coordinate : point) {
        require_value(is_finite(coordinate), function, "maps", coordinate, "finite canonical coordinates");
    }
}

} // namespace detail

/// A frame's samples: of every cell of a feature map up to 4 x 4 of the map's pixels for each object in it, and the
/// pixel that stands for the cell's token.
template <std::size_t D>
class frame_samples {
    using sample = typename object_samples<D>::sample;

public:
    /// Rows and columns of parts of a cell.
    static constexpr std::size_t samples_per_side = 4;

    /// Reads frame i of maps for feature maps of `grid`. `representative_of(token)` is the token's
    /// representative_pixel. Throws value_error if the grid does not divide the maps or canonical coordinates are not
    /// finite.
    template <canonical_maps Maps, class RepresentativeOf>
        requires(Maps::dimensions == D)
    frame_samples(Maps const& maps, frame_index i, grid_extents grid, double reach,
                  RepresentativeOf const& representative_of) {
        auto const cell = cell_extents("frame_samples", maps.grid(), grid);
        std::map<object_index, std::vector<sample>> found;
        cell_reader<Maps> reader(maps, i, cell);
        for (std::uint32_t t = 0; t < grid.size(); ++t) {
            reader.read(t / grid.width * cell.height, t % grid.width * cell.width);
            reader.add({t}, representative_of(token_index{t}), found);
        }
        for (auto& [object, samples] : found) {
            of_object_.try_emplace(object, std::move(samples), reach, cell);
        }
    }

    /// Bytes of a frame in which objects fill so many pixels of cells of that many, about.
    static constexpr std::size_t expected_bytes(std::size_t pixels, std::size_t cell) {
        return object_samples<D>::expected_bytes(expected_samples(pixels, cell));
    }

    /// Bytes that making such a frame takes for a moment, about: samples as they are found, in vectors that are a third
    /// empty.
    static constexpr std::size_t making_bytes(std::size_t pixels, std::size_t cell) {
        return expected_samples(pixels, cell) * sizeof(sample) * 3 / 2;
    }

    /// The samples of an object; null if the frame does not show it.
    object_samples<D> const* samples_of(object_index object) const {
        auto const found = of_object_.find(object);
        return found != of_object_.end() ? &found->second : nullptr;
    }

private:
    static constexpr std::size_t expected_samples(std::size_t pixels, std::size_t cell) {
        return pixels * std::min(samples_per_side * samples_per_side, cell) / cell;
    }

    /// The pixels of one cell, by object: how many, and of each part of the cell the one nearest to the part's middle.
    template <class Maps>
    class cell_reader {
    public:
        cell_reader(Maps const& maps, frame_index i, grid_extents cell)
            : maps_(maps), i_(i), cell_(cell), rows_(axis_of(cell.height)), columns_(axis_of(cell.width)) {}

        void read(std::size_t top, std::size_t left) {
            seen_.clear();
            for (std::size_t down = 0; down < cell_.height; ++down) {
                for (std::size_t right = 0; right < cell_.width; ++right) {
                    pixel const p{static_cast<std::uint32_t>(top + down), static_cast<std::uint32_t>(left + right)};
                    if (!maps_.is_covered(i_, p)) {
                        continue;
                    }
                    auto& object = entry_of(maps_.object_at(i_, p));
                    ++object.pixels;
                    auto const distance = rows_[down].square_to_middle + columns_[right].square_to_middle;
                    auto& nearest = object.nearest[rows_[down].part * samples_per_side + columns_[right].part];
                    if (!nearest || distance < nearest->distance) {
                        nearest = {distance, p};
                    }
                }
            }
        }

        /// Adds what was read to the samples of the objects.
        void add(token_index token, std::optional<pixel> representative,
                 std::map<object_index, std::vector<sample>>& found) const {
            for (auto const& object : seen_) {
                auto const purity = static_cast<double>(object.pixels) / static_cast<double>(cell_.size());
                auto& samples = found[object.number];
                auto is_sampled = !representative || maps_.object_at(i_, *representative) != object.number;
                for (auto const& nearest : object.nearest) {
                    if (nearest) {
                        samples.push_back(sample_at(nearest->at, token, purity));
                        is_sampled = is_sampled || nearest->at == *representative;
                    }
                }
                if (!is_sampled) {
                    samples.push_back(sample_at(*representative, token, purity));
                }
            }
        }

    private:
        struct candidate {
            std::int64_t distance;
            pixel at;
        };
        struct object_entry {
            object_index number;
            std::size_t pixels = 0;
            std::array<std::optional<candidate>, samples_per_side * samples_per_side> nearest{}; ///< by part
        };
        /// Along one axis: the part of the cell that holds a pixel, and the squared distance, in whole units, from the
        /// part's middle.
        struct axis_place {
            std::size_t part;
            std::int64_t square_to_middle;
        };

        static std::vector<axis_place> axis_of(std::size_t extent) {
            std::vector<axis_place> axis(extent);
            for (std::size_t place = 0; place < extent; ++place) {
                auto const part = place * samples_per_side / extent;
                auto const middle = static_cast<std::int64_t>((2 * part + 1) * extent);
                auto const at = static_cast<std::int64_t>((2 * place + 1) * samples_per_side);
                axis[place] = {part, (at - middle) * (at - middle)};
            }
            return axis;
        }

        object_entry& entry_of(object_index number) {
            // Most pixels show what the one before shows, and a cell seldom shows more than two.
            if (!seen_.empty() && seen_.back().number == number) {
                return seen_.back();
            }
            auto const known =
                std::find_if(seen_.begin(), seen_.end(), [&](auto const& entry) { return entry.number == number; });
            return known != seen_.end() ? *known : seen_.emplace_back(object_entry{number});
        }

        sample sample_at(pixel p, token_index token, double purity) const {
            auto const place = maps_.point_at(i_, p);
            detail::require_finite_point("frame_samples", place);
            auto const footprint = footprint_at(maps_, i_, p);
            auto const quality = footprint ? purity / footprint->area() : 0;
            auto const most = double{std::numeric_limits<float>::max()};
            return {place, footprint, {token, static_cast<float>(std::min(quality, most))}};
        }

        Maps const& maps_;
        frame_index i_;
        grid_extents cell_;
        std::vector<axis_place> rows_;
        std::vector<axis_place> columns_;
        std::vector<object_entry> seen_;
    };

    std::map<object_index, object_samples<D>> of_object_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
