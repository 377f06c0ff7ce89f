// SPDX-License-Identifier: MIT
// Networks in diffusers' words, their inputs and what diffusers makes of them: data/diffusers.json, which
// make_golden.py writes.
#pragma once

#include "../support/golden_file.hpp"

#include <genrender/core/index.hpp>

#include <array>
#include <cstddef>
#include <string>

namespace genrender::testing {

/// Evenly spaced elements of an output [1, channels, height, width] of diffusers.
struct golden_output {
    std::size_t step;               ///< between them
    double range;                   ///< largest minus smallest element of the whole output
    std::array<double, 96> single;  ///< in single precision
    std::array<double, 96> precise; ///< in double precision, the sinusoids of time too
};

/// What golden_data.py calls numbers.
inline golden_output read_golden_output(nlohmann::json const& from) {
    return {from.at("step").get<std::size_t>(), from.at("range").get<double>(),
            from.at("single").get<std::array<double, 96>>(), from.at("precise").get<std::array<double, 96>>()};
}

/// A UNet and its ControlNet. Weights and inputs are golden_values of their names.
struct golden_case {
    std::string name;
    grid_extents grid;           ///< of the latents
    std::size_t tokens;          ///< of the prompt
    double t;                    ///< time
    double scale;                ///< of what the ControlNet adds
    std::string unet_json;       ///< config.json as diffusers writes it
    std::string controlnet_json; ///< config.json as diffusers writes it
    golden_output alone;         ///< without the ControlNet
    golden_output controlled;    ///< with it
};

/// A tiny one whose hint is as large as the latents, a small Stable Diffusion 1.5, a small 2.x, and one whose ways down and up differ.
inline std::array<golden_case, 4> const& golden_cases() {
    static std::array<golden_case, 4> const cases = [] {
        auto const file = golden_file("diffusers.json");
        std::array<golden_case, 4> read;
        for (std::size_t c = 0; c < read.size(); ++c) {
            auto const& from = file.at("cases").at(c);
            auto const grid = from.at("grid").get<std::array<std::size_t, 2>>();
            read[c] = {from.at("name").get<std::string>(),
                       {grid[0], grid[1]},
                       from.at("tokens").get<std::size_t>(),
                       from.at("t").get<double>(),
                       from.at("scale").get<double>(),
                       from.at("unet").dump(2),
                       from.at("controlnet").dump(2),
                       read_golden_output(from.at("alone")),
                       read_golden_output(from.at("controlled"))};
        }
        return read;
    }();
    return cases;
}

} // namespace genrender::testing
