// SPDX-License-Identifier: MIT
// [GR sec. 3.2] One correspondence map per feature resolution of a network.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/correspondence/correspondence_map.hpp>
#include <genrender/core/error.hpp>

#include <map>
#include <string>

namespace genrender {

/// Correspondence maps by the extents of their feature grid, each compiled once for the whole animation.
template <correspondence_map Map>
class correspondence_set {
public:
    /// Adds the map of `grid`, made by `make(grid)`, unless there is one.
    template <class Make>
    void add(grid_extents grid, Make&& make) {
        if (!maps_.contains(grid)) {
            maps_.emplace(grid, make(grid));
        }
    }

    /// The map of a grid. Throws value_error if none was added.
    Map const& at(grid_extents grid) const {
        auto const found = maps_.find(grid);
        if (found == maps_.end()) {
            throw value_error("correspondence_set: grid is " + extents_text({grid.height, grid.width}) +
                              ", expected one of the " + std::to_string(maps_.size()) + " grids added");
        }
        return found->second;
    }

    auto begin() const { return maps_.begin(); }
    auto end() const { return maps_.end(); }

private:
    std::map<grid_extents, Map> maps_;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
