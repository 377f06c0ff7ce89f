// SPDX-License-Identifier: MIT
// A lender that joins what it may not write.
// expected: latent_lender: joined(stacks) is const, takes std::span<latents_type const> and returns latents_type
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct lender_that_joins_in_place : right_lender {
    engine_latents joined(std::span<engine_latents> stacks) const;
};

void run(lender_that_joins_in_place const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
