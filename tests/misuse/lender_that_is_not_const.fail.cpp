// SPDX-License-Identifier: MIT
// A lender with an operation that is not const.
// expected: latent_lender: all_finite(z) is const, takes latents_type const& and returns whether all elements are finite
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct lender_that_is_not_const : right_lender {
    bool all_finite(engine_latents const& z);
};

void run(lender_that_is_not_const const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
