// SPDX-License-Identifier: MIT
// One network of golden.hpp: its description in diffusers' words, its inputs and what diffusers makes of them.
#pragma once

#include <genrender/core/index.hpp>

#include <array>
#include <cstddef>

namespace genrender::testing {

/// Evenly spaced elements of an output [1, channels, height, width] of diffusers.
struct golden_output {
    std::size_t step;               ///< between them
    double range;                   ///< largest minus smallest element of the whole output
    std::array<double, 96> single;  ///< in single precision
    std::array<double, 96> precise; ///< in double precision, the sinusoids of time too
};

/// A UNet and its ControlNet. Weights and inputs are golden_values of their names.
struct golden_case {
    char const* name;
    grid_extents grid;           ///< of the latents
    std::size_t tokens;          ///< of the prompt
    double t;                    ///< time
    double scale;                ///< of what the ControlNet adds
    char const* unet_json;       ///< config.json as diffusers writes it
    char const* controlnet_json; ///< config.json as diffusers writes it
    golden_output alone;         ///< without the ControlNet
    golden_output controlled;    ///< with it
};

} // namespace genrender::testing
