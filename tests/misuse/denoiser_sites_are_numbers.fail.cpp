// SPDX-License-Identifier: MIT
// A denoiser whose sites are no attention_site.
// expected: denoiser: sites() is const and returns a random access range of attention_site
#include <genrender/pipeline/render.hpp>

#include "right_models.hpp"

struct sites_are_numbers : right_denoiser {
    std::span<int const> sites() const;
};

void run(sites_are_numbers const& phi, genrender::uv_maps_view const& UV) { genrender::render(phi, UV, {}); }
