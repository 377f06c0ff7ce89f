// SPDX-License-Identifier: MIT
// [GR sec. 3.2] The correspondence that settings choose: by footprints, or by the paper's texels.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/footprint_map.hpp>
#include <genrender/correspondence/texel_grid.hpp>
#include <genrender/correspondence/token_matches.hpp>
#include <genrender/maps/canonical_maps.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace genrender {

/// How tokens are matched.
enum class correspondence_kind : std::uint8_t {
    footprint, ///< footprint_map: nothing to set, any canonical coordinates
    texel_grid ///< the paper's texels, which take UV maps and a resolution
};

/// Which correspondence and how.
struct correspondence_settings {
    correspondence_kind kind = correspondence_kind::footprint; ///< which correspondence
    footprint_map_settings footprint{};                        ///< of correspondence_kind::footprint
    texel_grid_settings texels{};                              ///< of correspondence_kind::texel_grid
};

/// One of the library's correspondence maps behind one type: a model of weighted_, bounded_ and
/// graded_correspondence_map.
template <std::size_t D>
class chosen_correspondence {
    using footprints = footprint_map<D>;

public:
    /// A surface point of the map that was chosen; others are of no use to it.
    using point_type = std::variant<typename footprints::point_type, texel_grid::point_type>;

    /// Of maps for feature maps of `grid`; what views view must outlive it and stay as it is. Throws as the chosen map
    /// does, value_error for texels of maps that are not UV maps.
    template <canonical_maps Maps>
        requires(Maps::dimensions == D)
    chosen_correspondence(Maps const& maps, grid_extents grid, correspondence_settings const& settings,
                          any_loop const& loop = {})
        : map_(make(maps, grid, settings, loop)) {}

    /// Number of frames.
    std::size_t frame_count() const {
        return std::visit([](auto const& map) { return map.frame_count(); }, map_);
    }
    /// Height and width of the feature map.
    grid_extents grid() const {
        return std::visit([](auto const& map) { return map.grid(); }, map_);
    }

    /// The surface point that the token shows; none on the background.
    std::optional<point_type> point_at(frame_index frame, token_index token) const {
        return std::visit([&](auto const& map) -> std::optional<point_type> { return map.point_at(frame, token); },
                          map_);
    }

    /// The token of the frame that shows the point; none where it is hidden or out of view.
    std::optional<token_index> token_at(frame_index frame, point_type const& point) const {
        return std::visit([&](auto const& map) { return map.token_at(frame, own_point(map, point)); }, map_);
    }

    /// footprint_map's matches; none of texels, which several tokens may show.
    std::vector<std::shared_ptr<token_matches const>> matches(frame_index from, std::span<frame_index const> to) const {
        auto const* const map = std::get_if<footprints>(&map_);
        return map != nullptr ? map->matches(from, to) : std::vector<std::shared_ptr<token_matches const>>{};
    }

    /// Texels may be shown by several tokens, footprints by one.
    template <class Visit>
    void visit_tokens(frame_index frame, point_type const& point, Visit&& visit) const {
        if (auto const* const texels = std::get_if<texel_grid>(&map_)) {
            texels->visit_tokens(frame, own_point(*texels, point), visit);
        } else if (auto const token = token_at(frame, point)) {
            visit(*token, 1.0);
        }
    }

    /// The most tokens that a frame shows a point by: those of texels, 1 of footprints.
    std::size_t most_tokens() const {
        auto const* const texels = std::get_if<texel_grid>(&map_);
        return texels != nullptr ? texels->most_tokens() : 1;
    }

    /// Texels do not tell how well they are seen: all alike.
    double quality_at(frame_index frame, point_type const& point) const {
        if (auto const* const map = std::get_if<footprints>(&map_)) {
            return map->quality_at(frame, own_point(*map, point));
        }
        return token_at(frame, point) ? 1 : 0;
    }

private:
    using any_map = std::variant<footprints, texel_grid>;

    template <class Map>
    static typename Map::point_type const& own_point(Map const&, point_type const& point) {
        return std::get<typename Map::point_type>(point);
    }

    template <class Maps>
    static any_map make(Maps const& maps, grid_extents grid, correspondence_settings const& settings,
                        any_loop const& loop) {
        if (settings.kind == correspondence_kind::footprint) {
            return any_map(std::in_place_type<footprints>, maps, grid, settings.footprint, loop);
        }
        if constexpr (std::same_as<Maps, uv_maps_view>) {
            return any_map(std::in_place_type<texel_grid>, maps, grid, settings.texels, loop);
        } else {
            throw value_error(
                "chosen_correspondence: settings.kind is texel_grid, expected footprint for maps that are "
                "not UV maps");
        }
    }

    any_map map_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
