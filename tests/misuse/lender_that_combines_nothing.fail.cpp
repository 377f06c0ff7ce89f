// SPDX-License-Identifier: MIT
// A lender whose combination returns nothing.
// expected: latent_lender: combination(factors, in) is const, takes std::span<real_type const> and std::span<latents_type const> and returns latents_type
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct lender_that_combines_nothing : right_lender {
    void combination(std::span<float const> factors, std::span<engine_latents const> in) const;
};

void run(lender_that_combines_nothing const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
