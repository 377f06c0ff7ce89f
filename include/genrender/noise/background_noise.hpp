// SPDX-License-Identifier: MIT
// [GR sec. 3.3] What receives noise where there is no object: the screen, or the surroundings that a camera turns in.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/error.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/random.hpp>
#include <genrender/correspondence/surface_footprint.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace genrender {

/// Which noise what shows no object receives.
enum class background_noise : std::uint8_t {
    fixed,       ///< one image for all frames
    independent, ///< another image for each frame
    environment  ///< that of the direction in which the camera looks: it turns with the camera and ignores its place
};

/// The directions in which the pixels of the maps look, which background_noise::environment needs.
struct environment_rays {
    /// A direction in world space, of any length above 0, for a place on the screen in pixels of the maps: (0, 0) is
    /// the corner at the top left, rows come first.
    std::function<std::array<double, 3>(frame_index, double row, double column)> direction = {};

    /// A pixel's unit direction, and how it changes to the pixel on the right and the one below.
    struct ray {
        std::array<float, 3> direction; ///< from the camera, of length 1
        surface_footprint<3> footprint; ///< change of the direction to the pixel on the right and the one below
    };

    /// Throws value_error if there is no function, or its directions are not finite or 0.
    ray at(frame_index i, pixel p) const {
        require_value(direction != nullptr, "environment_rays", "direction", "empty", "a function");
        auto const middle = unit(i, p.row + 0.5, p.column + 0.5);
        auto const right = unit(i, p.row + 0.5, p.column + 1.5);
        auto const below = unit(i, p.row + 1.5, p.column + 0.5);
        ray result{middle, {}};
        for (std::size_t d = 0; d < 3; ++d) {
            result.footprint.across[d] = right[d] - middle[d];
            result.footprint.down[d] = below[d] - middle[d];
        }
        return result;
    }

private:
    std::array<float, 3> unit(frame_index i, double row, double column) const {
        auto const given = direction(i, row, column);
        auto const length = std::hypot(given[0], given[1], given[2]);
        require_value(length > 0 && is_finite(length), "environment_rays", "length of direction", length,
                      "a finite number above 0");
        return {static_cast<float>(given[0] / length), static_cast<float>(given[1] / length),
                static_cast<float>(given[2] / length)};
    }
};

/// The value of N(0, 1) of a pixel of the screen and channel: of all frames with background_noise::fixed, of frame i
/// alone otherwise; other diffusion steps have values of their own. Channels and steps are below 2^16.
inline double screen_noise(std::uint64_t seed, background_noise kind, frame_index i, std::uint32_t step,
                           std::uint32_t pixel, std::uint32_t channel) {
    auto const address = channel | step << 16;
    return kind == background_noise::fixed ? normal_value(seed, random_stream::background_noise, {0, pixel, address})
                                           : normal_value(seed, random_stream::frame_noise, {i.value, pixel, address});
}

} // namespace genrender

#include <genrender/core/end_header.inl>
