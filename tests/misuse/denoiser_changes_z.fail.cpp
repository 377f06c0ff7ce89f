// SPDX-License-Identifier: MIT
// A denoiser that takes z as latents it may change.
// expected: takes z as strided_view<real_type const, 4>: it is not changed
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct changes_z : right_denoiser {
    template <class Processor>
    void operator()(strided_view<float, 4> x0, strided_view<float, 4> z, float sigma,
                    std::span<frame_index const> frames, Processor& processor) const;
};

void run(changes_z const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
