// SPDX-License-Identifier: MIT
// A denoiser that takes one processor and is no template.
// expected: and is a template for every processor
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct of_one_processor : right_denoiser {
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, genrender::plain_attention& processor) const;
};

void run(of_one_processor const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
