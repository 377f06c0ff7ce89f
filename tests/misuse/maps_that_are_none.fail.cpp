// SPDX-License-Identifier: MIT
// A span of numbers in place of maps.
// expected: canonical_maps: maps can be copied and have `dimensions`, a constant of 2 or 3
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

void run(right_denoiser const& phi, std::span<float> no_maps) { genrender::render(phi, no_maps, {}); }
