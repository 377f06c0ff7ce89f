// SPDX-License-Identifier: MIT
// A lender whose call takes views alone.
// expected: latent_lender: operator()(z, sigma, frames, processor) is const, takes z as latents_type const&, sigma as real_type, frames as std::span<frame_index const>, is a template for every processor and returns latents_type
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct lender_without_call : right_lender {
    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const;
};

void run(lender_without_call const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
