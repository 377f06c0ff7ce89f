// SPDX-License-Identifier: MIT
// A run by what is no method.
// expected: render: Method is a sequence_method
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct no_method {};

void run(right_denoiser const& phi, genrender::uv_maps_view const& UV) { genrender::render<no_method>(phi, UV, {}); }
