// SPDX-License-Identifier: MIT
// A lender that has upload alone.
// expected: latent_lender: download(to, z) is const and takes strided_view<real_type, 4> and latents_type const&
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct lender_without_download : right_lender {
    void download(strided_view<float, 4> to) const;
};

void run(lender_without_download const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
