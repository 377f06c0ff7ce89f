// SPDX-License-Identifier: MIT
// A denoiser whose call of the processor is not const.
// expected: denoiser: operator()(x0, z, sigma, frames, processor) is const
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct not_const : right_denoiser {
    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor);
};

void run(not_const const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
