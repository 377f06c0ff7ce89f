// SPDX-License-Identifier: MIT
// [GR sec. 3.2, supplement: effect of texture resolution] Correspondence without a texture: tokens meet where a surface
// point lies under a cell of the feature map, however large the surface appears.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>
#include <genrender/core/instance.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/frame_cache.hpp>
#include <genrender/correspondence/frame_samples.hpp>
#include <genrender/correspondence/sample_source.hpp>
#include <genrender/correspondence/surface_footprint.hpp>
#include <genrender/correspondence/token_matches.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/maps/cell_extents.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace genrender {

/// How far a footprint reaches, and how much memory the caches take that find tokens fast.
struct footprint_map_settings {
    /// A frame shows a point if it lies at most this many half cells, along each axis of the screen, from something
    /// that the frame shows of the same object. Above 0.
    double reach = 1;
    /// Bytes of matches between frames that a map's cache may hold for later steps.
    std::size_t match_cache_bytes = std::size_t{64} << 20;
    /// Frames in which a map can find tokens without reading the maps again; its cache holds at least as many as it is
    /// asked for matches with at once.
    std::size_t cached_frames = 8;
};

/// A model of correspondence_map over canonical coordinates of D dimensions, UVs or rest positions. Every cell of the
/// feature map has samples, up to 4 x 4 of the map's pixels for each object in it, with their footprints; a point is
/// shown by the cell whose sample lies closest to it on that frame's screen. Points of surfaces that face the other way,
/// such as the second half of a mirrored texture or the back of a thin sheet, do not meet.
///
/// Holds a copy of the maps, which for views means that what they view must outlive it and stay as it is, and of each
/// frame no more than a pixel a token: the samples of a frame are made when it is asked for, and a cache has those of
/// the last few.
template <std::size_t D>
class footprint_map {
public:
    using point_type = footprint_point<D>; ///< a surface point and how its pixel sees it

    /// Reads maps for feature maps of `grid`. Throws value_error if the grid does not divide the maps, canonical
    /// coordinates are not finite, or reach is not above 0.
    template <canonical_maps Maps>
        requires(Maps::dimensions == D)
    footprint_map(Maps const& maps, grid_extents grid, footprint_map_settings const& settings = {},
                  any_loop const& loop = {})
        : grid_(grid), match_cache_(std::make_shared<match_cache>(settings.match_cache_bytes)),
          frame_cache_(std::make_shared<frame_cache<frame_samples<D>>>(settings.cached_frames)) {
        require_value(settings.reach > 0, "footprint_map", "settings.reach", settings.reach, "a number above 0");
        cell_extents("footprint_map", maps.grid(), grid);
        source_ = detail::read_samples(maps, grid, settings.reach, loop);
    }

    /// Frames of the maps.
    std::size_t frame_count() const { return source_->frame_count(); }
    /// Height and width of the feature map.
    grid_extents grid() const { return grid_; }

    /// The surface point under the token's representative pixel.
    std::optional<point_type> point_at(frame_index frame, token_index token) const {
        return source_->point_at(frame, token);
    }

    /// The token whose cell shows the point in that frame: of its samples the closest on the screen, ties by lowest
    /// token.
    std::optional<token_index> token_at(frame_index frame, point_type const& point) const {
        auto const match = match_of(frame, point);
        return match ? std::optional(match->token) : std::nullopt;
    }

    /// The same for the points of all tokens of a frame, in each of several others. What was asked once is in a
    /// cache, see footprint_map_settings::match_cache_bytes.
    std::vector<std::shared_ptr<token_matches const>> matches(frame_index from, std::span<frame_index const> to) const;

    /// How well a frame shows a point, for averages over keyframes: the share of the cell that the point's object owns
    /// times how many of the frame's pixels a unit of surface fills; 0 where the frame does not show it.
    double quality_at(frame_index frame, point_type const& point) const {
        auto const match = match_of(frame, point);
        return match ? double{match->quality} : 0;
    }

    /// Bytes of a map of `frames` frames and so many tokens, about, besides its caches.
    static constexpr std::size_t expected_bytes(std::size_t frames, std::size_t tokens) {
        return frames * (sizeof(detail::representative_pixels) + tokens * sizeof(std::uint32_t) + tokens / 8);
    }

private:
    std::shared_ptr<frame_samples<D> const> samples_in(frame_index i) const {
        return frame_cache_->of(i, [&] { return source_->samples_in(i); });
    }

    std::optional<token_match> match_of(frame_index i, point_type const& point) const {
        auto const frame = samples_in(i);
        auto const* const sample = sample_of(*frame, point);
        return sample != nullptr ? std::optional(sample->match) : std::nullopt;
    }

    /// The sample of a frame that shows a point; null if none does.
    static typename object_samples<D>::sample const* sample_of(frame_samples<D> const& frame, point_type const& point) {
        auto const* const samples = frame.samples_of(point.object);
        return samples != nullptr ? samples->sample_of(point) : nullptr;
    }

    static token_matches match(std::vector<std::optional<point_type>> const& points, frame_samples<D> const& to) {
        token_matches result(points.size());
        for (std::size_t t = 0; t < points.size(); ++t) {
            if (auto const* const sample = points[t] ? sample_of(to, *points[t]) : nullptr) {
                result.tokens[t] = sample->match.token.value;
                result.is_shown[t] = 1;
                result.qualities[t] = sample->match.quality;
            }
        }
        return result;
    }

    grid_extents grid_;
    std::shared_ptr<detail::sample_source<D> const> source_;
    // Shared by copies, for which all is the same.
    std::shared_ptr<match_cache> match_cache_;
    std::shared_ptr<frame_cache<frame_samples<D>>> frame_cache_;
};

template <std::size_t D>
std::vector<std::shared_ptr<token_matches const>> footprint_map<D>::matches(frame_index from,
                                                                            std::span<frame_index const> to) const {
    std::vector<std::shared_ptr<token_matches const>> result(to.size());
    frame_cache_->grow_to(to.size());
    // Points are read once for all that the cache has not, and no call allocates them anew.
    thread_local std::vector<std::optional<point_type>> points;
    points.clear();
    for (std::size_t n = 0; n < to.size(); ++n) {
        // Neighbouring frames, which other threads ask for, begin elsewhere: each makes other frames ready.
        auto const k = (from.value + n) % to.size();
        result[k] = match_cache_->of(from, to[k], [&] {
            for (std::uint32_t t = 0; points.size() < grid_.size(); ++t) {
                points.push_back(point_at(from, {t}));
            }
            return match(points, *samples_in(to[k]));
        });
    }
    return result;
}

GENRENDER_CLASS_INSTANCE(footprint_map<2>);
GENRENDER_CLASS_INSTANCE(footprint_map<3>);

/// Deduces the dimensions from the maps.
template <canonical_maps Maps>
footprint_map(Maps const&, grid_extents, footprint_map_settings const& = {}, any_loop const& = {})
    -> footprint_map<Maps::dimensions>;

} // namespace genrender

#include <genrender/core/end_header.inl>
