// SPDX-License-Identifier: MIT
// A run small enough to be compiled twice, and its latents as text.
#pragma once

#include <genrender/maps/uv_maps.hpp>
#include <genrender/maps/uv_maps_view.hpp>
#include <genrender/pipeline/render.hpp>

#include <cstdio>

/// Renders four frames of a surface that moves and prints every latent to the last bit.
template <class Phi>
int print_frames(Phi const& phi) {
    genrender::uv_maps maps(4, {16, 24});
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t row = 2; row < 14; ++row) {
            for (std::size_t column = 2; column < 22; ++column) {
                maps.coverage(i, row, column) = 1;
                maps.uv(i, row, column, 0) = 0.1F + 0.02F * static_cast<float>(column + i);
                maps.uv(i, row, column, 1) = 0.1F + 0.03F * static_cast<float>(row);
            }
        }
    }
    genrender::render_settings<float> settings;
    settings.steps = 3;
    settings.keyframes.count = 2;
    auto const result = genrender::render(phi, to_uv_view(maps), {.settings = settings});
    for (auto const value : result.z) {
        std::printf("%a\n", static_cast<double>(value));
    }
    return 0;
}
