// SPDX-License-Identifier: MIT
// Maps whose objects are numbers.
// expected: canonical_maps: object_at(frame, pixel) is const and returns object_index
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct wrong_maps : genrender::uv_maps_view {
    int object_at(genrender::frame_index, genrender::pixel) const;
};

void run(right_denoiser const& phi, wrong_maps const& maps) { genrender::render(phi, maps, {}); }
