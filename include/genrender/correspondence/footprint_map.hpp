// SPDX-License-Identifier: MIT
// [GR sec. 3.2, supplement: effect of texture resolution] Correspondence without a texture: tokens meet where a surface
// point lies under a cell of the feature map, however large the surface appears.
#pragma once

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/correspondence/kept_samples.hpp>
#include <genrender/correspondence/representative_pixel.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/correspondence/token_matches.hpp>
#include <genrender/guidance/canonical_maps.hpp>
#include <genrender/guidance/cell_extents.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace genrender {

/// How far a footprint reaches.
struct footprint_map_settings {
    /// A frame shows a point if it lies at most this many half cells, along each axis of the screen, from something
    /// that the frame shows of the same object. Above 0.
    double reach = 1;
    /// Bytes of matches between frames that a map may keep for later steps.
    std::size_t kept_bytes = std::size_t{64} << 20;
};

/// A model of correspondence_map over canonical coordinates of D dimensions, UVs or rest positions. Every cell of the
/// feature map keeps up to 4 x 4 of the map's pixels for each object in it, with their footprints; a point is shown by
/// the cell whose kept pixel lies closest to it on that frame's screen. Points of surfaces that face the other way, such
/// as the second half of a mirrored texture or the back of a thin sheet, do not meet.
template <std::size_t D>
class footprint_map {
public:
    using point_type = footprint_point<D>;

    /// Compiles maps for feature maps of `grid`. Throws value_error if the grid does not divide the maps, canonical
    /// coordinates are not finite, or reach is not above 0.
    template <canonical_maps Maps, parallel_loop Loop = sequential_loop>
        requires(Maps::dimensions == D)
    footprint_map(Maps const& maps, grid_extents grid, footprint_map_settings const& settings = {},
                  Loop const& loop = {})
        : grid_(grid), reach_(settings.reach), frames_(maps.frame_count()),
          matches_(std::make_shared<kept_matches>(settings.kept_bytes)) {
        require_value(settings.reach > 0, "footprint_map", "settings.reach", settings.reach, "a number above 0");
        cell_ = cell_extents("footprint_map", maps.grid(), grid);
        loop(frames_.size(), [&](std::size_t i) { compile(maps, {static_cast<std::uint32_t>(i)}); });
    }

    std::size_t frame_count() const { return frames_.size(); }
    grid_extents grid() const { return grid_; }

    /// The surface point under the token's representative pixel.
    std::optional<point_type> point_at(frame_index frame, token_index token) const {
        return frames_[frame.value].shown[token.value];
    }

    /// The token whose cell shows the point in that frame: of the kept pixels the closest on the screen, ties by lowest
    /// token.
    std::optional<token_index> token_at(frame_index frame, point_type const& point) const {
        auto const* const found = sample_in(frames_[frame.value], point);
        return found != nullptr ? std::optional(found->token) : std::nullopt;
    }

    /// The same for the points of all tokens of another frame. What was asked once is kept, see
    /// footprint_map_settings::kept_bytes.
    std::shared_ptr<token_matches const> matches(frame_index from, frame_index to) const {
        return matches_->of(from, to, [&] { return match(frames_[from.value], frames_[to.value]); });
    }

    /// How well a frame shows a point, for averages over keyframes: the share of the cell that the point's object owns
    /// times how many of the frame's pixels a unit of surface fills; 0 where the frame does not show it.
    double quality_at(frame_index frame, point_type const& point) const {
        auto const* const found = sample_in(frames_[frame.value], point);
        return found != nullptr ? found->quality() : 0;
    }

private:
    static constexpr std::size_t samples_per_side = 4;

    struct frame_entry {
        std::vector<std::optional<point_type>> shown; ///< [tokens]
        std::map<object_index, kept_samples<D>> of_object;
    };

    template <canonical_maps Maps>
    void compile(Maps const& maps, frame_index i) {
        auto& entry = frames_[i.value];
        entry.shown.resize(grid_.size());
        for (std::uint32_t t = 0; t < grid_.size(); ++t) {
            auto const representative = representative_pixel(maps, i, grid_, {t});
            if (representative) {
                auto const p = *representative;
                entry.shown[t] = point_type{maps.object_at(i, p), maps.point_at(i, p), footprint_at(maps, i, p)};
            }
            keep_samples(entry, maps, i, {t}, representative);
        }
        auto const spacing = std::max(1.0, std::sqrt(static_cast<double>(cell_.size())) / samples_per_side);
        for (auto& [object, kept] : entry.of_object) {
            kept.compile(reach_, cell_, spacing);
        }
    }

    /// Keeps, for each object and each part of a cell, the pixel nearest to the part's middle, and the representative.
    template <canonical_maps Maps>
    void keep_samples(frame_entry& entry, Maps const& maps, frame_index i, token_index token,
                      std::optional<pixel> representative) const {
        auto const top = token.value / grid_.width * cell_.height;
        auto const left = token.value % grid_.width * cell_.width;
        struct candidate {
            object_index object;
            std::size_t part;
            std::int64_t distance;
            pixel at;
        };
        std::vector<candidate> kept;
        std::map<object_index, std::size_t> owned;
        for (std::size_t down = 0; down < cell_.height; ++down) {
            auto const part_row = down * samples_per_side / cell_.height;
            for (std::size_t right = 0; right < cell_.width; ++right) {
                pixel const p{static_cast<std::uint32_t>(top + down), static_cast<std::uint32_t>(left + right)};
                if (!maps.is_covered(i, p)) {
                    continue;
                }
                for (auto const coordinate : maps.point_at(i, p)) {
                    require_value(std::isfinite(coordinate), "footprint_map", "maps", coordinate,
                                  "finite canonical coordinates");
                }
                auto const object = maps.object_at(i, p);
                ++owned[object];
                auto const part_column = right * samples_per_side / cell_.width;
                auto const part = part_row * samples_per_side + part_column;
                auto const distance =
                    square_to_middle(down, part_row, cell_.height) + square_to_middle(right, part_column, cell_.width);
                auto const known = std::find_if(
                    kept.begin(), kept.end(), [&](candidate const& c) { return c.object == object && c.part == part; });
                if (known == kept.end()) {
                    kept.push_back({object, part, distance, p});
                } else if (distance < known->distance) {
                    known->distance = distance;
                    known->at = p;
                }
            }
        }
        if (representative &&
            std::none_of(kept.begin(), kept.end(), [&](candidate const& c) { return c.at == *representative; })) {
            kept.push_back({maps.object_at(i, *representative), 0, 0, *representative});
        }
        for (auto const& c : kept) {
            auto const purity = static_cast<float>(owned[c.object]) / static_cast<float>(cell_.size());
            auto const footprint = footprint_at(maps, i, c.at);
            auto const density = footprint ? 1 / footprint->area() : 0;
            entry.of_object[c.object].add({token, purity, maps.point_at(i, c.at), footprint, density});
        }
    }

    /// Squared distance, in whole units, of a pixel of a cell from the middle of its part along one axis.
    static std::int64_t square_to_middle(std::size_t place, std::size_t part, std::size_t extent) {
        auto const middle = static_cast<std::int64_t>((2 * part + 1) * extent);
        auto const at = static_cast<std::int64_t>((2 * place + 1) * samples_per_side);
        return (at - middle) * (at - middle);
    }

    token_matches match(frame_entry const& from, frame_entry const& to) const {
        auto const tokens = grid_.size();
        token_matches result(tokens);
        for (std::size_t t = 0; t < tokens; ++t) {
            auto const& point = from.shown[t];
            if (auto const* const found = point ? sample_in(to, *point) : nullptr) {
                result.tokens[t] = found->token.value;
                result.is_shown[t] = 1;
                result.qualities[t] = found->quality();
            }
        }
        return result;
    }

    static typename kept_samples<D>::sample const* sample_in(frame_entry const& frame, point_type const& point) {
        auto const found = frame.of_object.find(point.object);
        return found != frame.of_object.end() ? found->second.sample_at(point) : nullptr;
    }

    grid_extents grid_;
    grid_extents cell_;
    double reach_;
    std::vector<frame_entry> frames_;
    std::shared_ptr<kept_matches> matches_; ///< shared by copies, for which all is the same
};

/// Deduces the dimensions from the maps.
template <canonical_maps Maps, parallel_loop Loop = sequential_loop>
footprint_map(Maps const&, grid_extents, footprint_map_settings const& = {}, Loop const& = {})
    -> footprint_map<Maps::dimensions>;

} // namespace genrender
