// SPDX-License-Identifier: MIT
// [GR sec. 3.2] One correspondence map per feature resolution of a network.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/core/error.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace genrender {

/// Correspondence maps by the extents of their grid, each compiled once for the whole animation, with the number of
/// tokens of each frame that show an object. Those of feature grids are listed; that of the latents, if it is of another
/// grid, is found by its extents alone.
template <correspondence_map Map>
class correspondence_set {
public:
    /// Adds the map of `grid`, made by `make(grid)`, unless there is one.
    template <class Make>
    void add(grid_extents grid, Make&& make) {
        if (unlisted_.contains(grid)) {
            maps_.insert(unlisted_.extract(grid));
        } else if (!maps_.contains(grid)) {
            count_tokens(maps_.emplace(grid, make(grid)).first->second, grid);
        }
    }

    /// Adds the map of the latents' `grid`, unless there is one: no feature map has to have this grid, so it is not among
    /// those from begin() to end() if it was not there before.
    template <class Make>
    void add_unlisted(grid_extents grid, Make&& make) {
        if (!maps_.contains(grid) && !unlisted_.contains(grid)) {
            count_tokens(unlisted_.emplace(grid, make(grid)).first->second, grid);
        }
    }

    /// The map of a grid, listed or not. Throws value_error if none was added.
    Map const& at(grid_extents grid) const { return found(unlisted_.contains(grid) ? unlisted_ : maps_, grid); }

    /// Tokens of a frame at a grid that show an object. Throws value_error if the grid was not added or has no such
    /// frame.
    std::size_t tokens_on_objects(grid_extents grid, frame_index i) const {
        auto const& counts = found(tokens_on_objects_, grid);
        require_value(i.value < counts.size(), "correspondence_set", "i", i.value, "a frame of the map");
        return counts[i.value];
    }

    /// Pairs of a feature grid and its map, by grid.
    auto begin() const { return maps_.begin(); }
    /// Past the last of these pairs.
    auto end() const { return maps_.end(); }

private:
    template <class Value>
    static Value const& found(std::map<grid_extents, Value> const& values, grid_extents grid) {
        auto const position = values.find(grid);
        if (position == values.end()) {
            throw value_error("correspondence_set: grid is " + extents_text({grid.height, grid.width}) +
                              ", expected one of the " + std::to_string(values.size()) + " grids added");
        }
        return position->second;
    }

    void count_tokens(Map const& map, grid_extents grid) {
        auto& counts = tokens_on_objects_[grid];
        for (std::uint32_t i = 0; i < map.frame_count(); ++i) {
            std::size_t count = 0;
            for (std::uint32_t t = 0; t < grid_extents(map.grid()).size(); ++t) {
                count += map.point_at({i}, {t}).has_value() ? 1U : 0U;
            }
            counts.push_back(count);
        }
    }

    std::map<grid_extents, Map> maps_;
    std::map<grid_extents, Map> unlisted_;
    std::map<grid_extents, std::vector<std::size_t>> tokens_on_objects_; // by frame
};

} // namespace genrender

#include <genrender/core/end_header.inl>
