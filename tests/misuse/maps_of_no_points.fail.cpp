// SPDX-License-Identifier: MIT
// Maps whose coordinates are of double precision.
// expected: canonical_maps: point_at(frame, pixel) is const and returns std::array<float, dimensions>
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct wrong_maps : genrender::uv_maps_view {
    std::array<double, 2> point_at(genrender::frame_index, genrender::pixel) const;
};

void run(right_denoiser const& phi, wrong_maps const& maps) { genrender::render(phi, maps, {}); }
