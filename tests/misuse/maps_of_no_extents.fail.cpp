// SPDX-License-Identifier: MIT
// Maps whose grid is a number.
// expected: canonical_maps: frame_count() is const and returns a number, grid() is const and returns grid_extents
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct wrong_maps : genrender::uv_maps_view {
    float grid() const;
};

void run(right_denoiser const& phi, wrong_maps const& maps) { genrender::render(phi, maps, {}); }
