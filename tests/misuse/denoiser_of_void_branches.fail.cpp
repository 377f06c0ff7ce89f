// SPDX-License-Identifier: MIT
// A denoiser that does not return the number of its guidance branches.
// expected: denoiser: branches() is const and returns the number of guidance branches
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct of_void_branches : right_denoiser {
    void branches() const;
};

void run(of_void_branches const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
