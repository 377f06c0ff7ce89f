// SPDX-License-Identifier: MIT
// A lender whose handles have one owner.
// expected: latent_lender: latents_type is copyable
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct lender_of_handles_that_are_not_copied : right_lender {
    struct latents_type {
        latents_type(latents_type&&) = default;
    };
};

void run(lender_of_handles_that_are_not_copied const& phi, genrender::uv_maps_view const& UV) {
    genrender::render(phi, UV, {});
}
