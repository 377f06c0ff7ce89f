// SPDX-License-Identifier: MIT
// A call of render, so that all of a run is compiled.
#pragma once

#include <genrender/genrender.hpp>
#include <genrender/testing/analytic_denoiser.hpp>

/// Renders maps with a denoiser. Not inline, or nobody would compile it.
std::size_t use_of_render(genrender::testing::analytic_denoiser<float> const& phi, genrender::uv_maps const& maps) {
    return genrender::render(phi, genrender::to_uv_view(maps), {}).z.size();
}
