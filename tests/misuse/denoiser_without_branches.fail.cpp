// SPDX-License-Identifier: MIT
// A denoiser that forgets its guidance branches.
// expected: denoiser: branches() is const and returns the number of guidance branches
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct without_branches : right_denoiser {
    std::size_t branches() const = delete;
};

void run(without_branches const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
