// SPDX-License-Identifier: MIT
// The low band of an image of which a part is known, by wavelets with holes: what is coarser than some pixels.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/index.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace genrender {

/// The low band of images over the pixels of a mask. One level is the kernel [1, 2, 1] / 4 along both axes with 2^level
/// pixels between its taps ("a trous"); S is all levels one after the other, 0 beyond the edges. With the mask m
///     low(v) = (S[m v] + w mean) / (S[m] + w),   mean = that of v over the mask,
/// w = 1 / 100: at every pixel, masked or not, the mean of the known values around it, and the mean of all where none is
/// near. low(v + constant) = low(v) + constant, and low is linear.
class low_band {
public:
    /// Of images of `grid`, known where `mask` [height * width] is not 0; of 1 to 12 levels. Throws value_error for another
    /// number, and for a mask of another size or of no pixel.
    low_band(grid_extents grid, std::vector<std::uint8_t> mask, std::size_t levels)
        : grid_(grid), mask_(std::move(mask)), levels_(levels) {
        require_value(levels >= 1 && levels <= 12, "low_band", "levels", levels, "1 to 12");
        require_value(mask_.size() == grid.size(), "low_band", "mask.size()", mask_.size(),
                      "a pixel a cell of the grid");
        for (auto const known : mask_) {
            pixels_ += known != 0 ? 1U : 0U;
            weights_.push_back(known != 0 ? 1.0 : 0.0);
        }
        require_value(pixels_ > 0, "low_band", "mask", "empty", "at least one known pixel");
        smooth(weights_);
    }

    /// Number of known pixels.
    std::size_t pixels() const { return pixels_; }

    /// The low band of `values` [height * width], of which those off the mask are not read as numbers. Throws value_error
    /// for another number of values.
    std::vector<double> operator()(std::vector<double> values) const {
        require_value(values.size() == grid_.size(), "low_band", "values.size()", values.size(),
                      "a value a cell of the grid");
        double sum = 0;
        for (std::size_t e = 0; e < values.size(); ++e) {
            values[e] = mask_[e] != 0 ? values[e] : 0;
            sum += values[e];
        }
        auto const mean = sum / static_cast<double>(pixels_);
        smooth(values);
        for (std::size_t e = 0; e < values.size(); ++e) {
            values[e] = (values[e] + far_weight * mean) / (weights_[e] + far_weight);
        }
        return values;
    }

private:
    static constexpr double far_weight = 0.01;

    /// One pass of the kernel along an axis of `count` values, `stride` apart, for each of `lines` first values.
    static void pass(std::vector<double>& values, std::array<std::size_t, 2> count_and_stride,
                     std::array<std::size_t, 2> lines_and_stride, std::size_t apart) {
        auto const [count, stride] = count_and_stride;
        auto const [lines, line_stride] = lines_and_stride;
        std::vector<double> line(count);
        for (std::size_t n = 0; n < lines; ++n) {
            for (std::size_t i = 0; i < count; ++i) {
                line[i] = values[n * line_stride + i * stride];
            }
            for (std::size_t i = 0; i < count; ++i) {
                auto const before = i >= apart ? line[i - apart] : 0.0;
                auto const after = i + apart < count ? line[i + apart] : 0.0;
                values[n * line_stride + i * stride] = (before + 2 * line[i] + after) / 4;
            }
        }
    }

    void smooth(std::vector<double>& values) const {
        for (std::size_t level = 0; level < levels_; ++level) {
            auto const apart = std::size_t{1} << level;
            pass(values, {grid_.width, 1}, {grid_.height, grid_.width}, apart);
            pass(values, {grid_.height, grid_.width}, {grid_.width, 1}, apart);
        }
    }

    grid_extents grid_;
    std::vector<std::uint8_t> mask_;
    std::size_t levels_;
    std::size_t pixels_ = 0;
    std::vector<double> weights_; // S[m]
};

} // namespace genrender

#include <genrender/core/end_header.inl>
