// SPDX-License-Identifier: MIT
// A denoiser whose latents are whole numbers.
// expected: denoiser: real_type is float or double and features_type is copyable
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct of_integers : right_denoiser {
    using real_type = int;
};

void run(of_integers const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
