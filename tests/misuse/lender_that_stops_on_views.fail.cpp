// SPDX-License-Identifier: MIT
// A lender that ends calls of views early, and no others.
// expected: latent_lender: run_until(z, sigma, frames, processor, last) takes z as latents_type const&, too, and where residuals are lent run_until(..., &lent) and operator()(z, sigma, frames, processor, lent)
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

#include <optional>

struct lender_that_stops_on_views : right_lender {
    template <class Processor>
    void run_until(strided_view<float const, 4> z, float sigma, std::span<frame_index const> frames,
                   Processor& processor, std::span<std::optional<genrender::site_index> const> last) const;
};

void run(lender_that_stops_on_views const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
