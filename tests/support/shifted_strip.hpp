// SPDX-License-Identifier: MIT
// A correspondence that can be checked by counting: an endless strip of surface points under a window of tokens.
#pragma once

#include <genrender/core/index.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace genrender::testing {

/// Frame i shows the points i, i + 1, ..., i + width - 1 of the strip in its `width` tokens.
struct shifted_strip {
    using point_type = std::uint32_t;
    std::size_t frames = 0;
    std::size_t width = 0;

    std::size_t frame_count() const { return frames; }
    grid_extents grid() const { return {1, width}; }
    std::optional<point_type> point_at(frame_index i, token_index t) const { return i.value + t.value; }
    std::optional<token_index> token_at(frame_index i, point_type point) const {
        return point >= i.value && point < i.value + width ? std::optional(token_index{point - i.value}) : std::nullopt;
    }
};

} // namespace genrender::testing
