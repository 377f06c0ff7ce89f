// SPDX-License-Identifier: MIT
// The same sentences without a run.
// expected: latent_lender: all_finite(z) is const, takes latents_type const& and returns whether all elements are finite
#include <genrender/sampling/latent_lender.hpp>

#include "right_models.hpp"

struct tells_nothing : right_lender {
    void all_finite(engine_latents const& z) const;
};

int main() { genrender::require_latent_lender<tells_nothing>(); }
