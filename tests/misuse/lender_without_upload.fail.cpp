// SPDX-License-Identifier: MIT
// A lender whose upload takes no view of constant elements.
// expected: latent_lender: upload(z) is const, takes strided_view<real_type const, 4> and returns latents_type
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct lender_without_upload : right_lender {
    engine_latents upload(strided_view<float, 4> z) const;
};

void run(lender_without_upload const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
