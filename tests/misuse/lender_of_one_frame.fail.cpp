// SPDX-License-Identifier: MIT
// A lender that gives one frame at a time.
// expected: latent_lender: frames_of(z, frames) is const, takes latents_type const& and std::span<frame_index const> and returns latents_type
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct lender_of_one_frame : right_lender {
    engine_latents frames_of(engine_latents const& z, frame_index frame) const;
};

void run(lender_of_one_frame const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
