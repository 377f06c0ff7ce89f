// SPDX-License-Identifier: MIT
// Settings of double precision for a network of single precision.
// expected: render: settings are render_settings<real_type of the denoiser>
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

void run(right_denoiser const& phi, genrender::uv_maps_view const& UV) {
    genrender::render(phi, UV, {.settings = genrender::render_settings<double>{}});
}
