// SPDX-License-Identifier: MIT
// Maps whose coverage is a share.
// expected: canonical_maps: is_covered(frame, pixel) is const and returns bool
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct wrong_maps : genrender::uv_maps_view {
    float is_covered(genrender::frame_index, genrender::pixel) const;
};

void run(right_denoiser const& phi, wrong_maps const& maps) { genrender::render(phi, maps, {}); }
