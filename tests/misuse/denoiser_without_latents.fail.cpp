// SPDX-License-Identifier: MIT
// A denoiser whose latents have a grid that is none.
// expected: denoiser: latent_channels() is const and returns a number, latent_grid() is const and returns grid_extents
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct without_latents : right_denoiser {
    float latent_grid() const;
};

void run(without_latents const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
