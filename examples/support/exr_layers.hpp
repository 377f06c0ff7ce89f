// SPDX-License-Identifier: MIT
// The pixels of a frame's view layers, composited by depth.
#pragma once

#include "exr_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace genrender::examples {

/// The surface at a pixel.
struct exr_surface {
    float u = 0;
    float v = 0;
    float depth = 0;
    std::uint32_t object = 0;
    std::array<float, 3> position{};
    bool is_mixed = false; ///< whether several surfaces, or a surface and background, share the pixel
};

/// The values of one layer of a frame.
class exr_layer_pixels {
public:
    /// Reads the layer's channels, positions too where asked for.
    exr_layer_pixels(exr_frame const& frame, exr_map_channels channels, bool has_position)
        : frame_(&frame), channels_(std::move(channels)), has_position_(has_position) {
        std::vector<exr_channel> wanted{channels_.u, channels_.v, channels_.depth};
        auto const add = [&](auto const& more) { wanted.insert(wanted.end(), more.begin(), more.end()); };
        if (channels_.alpha) {
            wanted.push_back(*channels_.alpha);
        }
        first_position_ = wanted.size();
        if (has_position_) {
            add(channels_.position);
        }
        first_object_ = wanted.size();
        if (channels_.object) {
            wanted.push_back(*channels_.object);
        } else {
            add(channels_.cryptomatte);
        }
        planes_ = frame.planes(wanted, 0.0f); // outside the data window alpha and depth are 0: background
        auto const is_zero = [](float value) { return value == 0; };
        has_alpha_ = channels_.alpha &&
                     (channels_.is_alpha_certain || !std::all_of(planes_[3].begin(), planes_[3].end(), is_zero));
    }

    /// The depth of the surface at a pixel, or nothing where background is. Throws file_error for a surface of which
    /// nobody knows how far it is.
    std::optional<float> depth(std::size_t pixel) const {
        auto const depth = planes_[2][pixel];
        if ((has_alpha_ && !(planes_[3][pixel] > 0)) ||
            (channels_.layout == exr_layout::plain && planes_[first_object_][pixel] < 0)) {
            return std::nullopt;
        }
        require(!std::isnan(depth), pixel, "depth is not a number", "how far the surface is, or 1e10 for background");
        return depth > 0 && depth < 1e10f ? std::optional(depth) : std::nullopt;
    }

    /// The surface at a pixel that has a depth. Throws file_error with row and column for impossible values.
    exr_surface surface(std::size_t pixel) const {
        // Cycles adds up the UVs of the samples that hit: alpha is their share
        auto const alpha = has_alpha_ ? planes_[3][pixel] : 1.0f;
        exr_surface s{planes_[0][pixel] / alpha, planes_[1][pixel] / alpha, planes_[2][pixel]};
        s.is_mixed = alpha < 1;
        require(std::isfinite(s.u) && std::isfinite(s.v), pixel, "UV is not a finite number",
                "texture coordinates where a surface is covered");
        if (channels_.object) {
            auto const object = planes_[first_object_][pixel];
            require(object >= 0 && object < 16777216.0f, pixel, "object index is " + std::to_string(object),
                    "0 to 2^24 - 1");
            s.is_mixed = s.is_mixed || object != std::round(object);
            s.object = static_cast<std::uint32_t>(std::lround(object));
        } else {
            auto const mattes = std::span(planes_).subspan(first_object_);
            auto const largest = largest_object(mattes, pixel);
            s.is_mixed = s.is_mixed || largest.coverage < 0.99f;
            s.object = largest.id;
        }
        for (std::size_t axis = 0; has_position_ && axis < 3; ++axis) {
            s.position[axis] = planes_[first_position_ + axis][pixel] / alpha;
            require(std::isfinite(s.position[axis]), pixel, "position is not a finite number",
                    "coordinates where a surface is covered");
        }
        return s;
    }

private:
    void require(bool holds, std::size_t pixel, std::string const& found, char const* expected) const {
        if (!holds) {
            auto const width = frame_->grid().width;
            throw file_error(frame_->path().string() + ": at row " + std::to_string(pixel / width) + ", column " +
                             std::to_string(pixel % width) + " the " + found + ", expected " + expected);
        }
    }

    exr_frame const* frame_;
    exr_map_channels channels_;
    std::vector<std::vector<float>> planes_; ///< u, v, depth, alpha if there is one, positions, objects
    std::size_t first_position_ = 0;
    std::size_t first_object_ = 0;
    bool has_position_ = false;
    bool has_alpha_ = false;
};

/// The nearest surface of the layers at a pixel, of equally near ones the first layer's; nothing where all show
/// background.
inline std::optional<exr_surface> nearest_surface(std::vector<exr_layer_pixels> const& layers, std::size_t pixel) {
    exr_layer_pixels const* nearest = nullptr;
    float nearest_depth = 0;
    for (auto const& layer : layers) {
        auto const depth = layer.depth(pixel);
        if (depth && (nearest == nullptr || *depth < nearest_depth)) {
            nearest = &layer;
            nearest_depth = *depth;
        }
    }
    return nearest != nullptr ? std::optional(nearest->surface(pixel)) : std::nullopt;
}

} // namespace genrender::examples
