// SPDX-License-Identifier: MIT
// Some of a map's pixels, spread evenly: what questions about a large map are asked of.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/index.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace genrender {

/// One pixel of each square of `stride` x `stride` pixels, the stride as small as a limit of pixels allows. Places
/// within the squares follow a sequence of low discrepancy, so that lines of a map do not fall between them.
class pixel_lattice {
public:
    /// At most `most` pixels of `grid`, all of them if they are no more; `most` counts as at least 1.
    pixel_lattice(grid_extents grid, std::size_t most) : grid_(grid) {
        while (squares(grid.height) * squares(grid.width) > std::max<std::size_t>(1, most)) {
            ++stride_;
        }
    }

    /// Rows and columns from one pixel of the lattice to the next.
    std::size_t stride() const { return stride_; }
    /// Number of pixels.
    std::size_t size() const { return squares(grid_.height) * squares(grid_.width); }

    /// Calls `visit(pixel)` for each, squares row by row.
    template <class Visit>
    void visit_pixels(Visit&& visit) const {
        std::size_t number = 0;
        for (std::size_t top = 0; top < grid_.height; top += stride_) {
            for (std::size_t left = 0; left < grid_.width; left += stride_, ++number) {
                // Reciprocals of the plastic number and of its square.
                auto const down = place(number, 0.7548776662466927, std::min(stride_, grid_.height - top));
                auto const right = place(number, 0.5698402909980532, std::min(stride_, grid_.width - left));
                visit(pixel{static_cast<std::uint32_t>(top + down), static_cast<std::uint32_t>(left + right)});
            }
        }
    }

private:
    std::size_t squares(std::size_t extent) const { return (extent + stride_ - 1) / stride_; }

    static std::size_t place(std::size_t number, double step, std::size_t extent) {
        auto const turns = static_cast<double>(number) * step;
        return static_cast<std::size_t>((turns - std::floor(turns)) * static_cast<double>(extent));
    }

    grid_extents grid_;
    std::size_t stride_ = 1;
};

} // namespace genrender

#include <genrender/core/end_header.inl>
