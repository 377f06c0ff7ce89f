// SPDX-License-Identifier: MIT
// render() with what is no denoiser, what are no maps, what is no method and settings of another scalar.
// expected: denoiser: branches() is const and returns the number of guidance branches
// expected: canonical_maps: maps can be copied and have dimensions
// expected: render: Method is a sequence_method
// expected (g++): invalid initialization of reference of type
// expected (clang++): no matching function for call to 'render'
#include "right_models.hpp"

#include <genrender/pipeline/render.hpp>

using namespace genrender;

struct without_branches : right_denoiser {
    void branches() const;
};
struct no_method {};

void run(without_branches const& wrong, right_denoiser const& phi, uv_maps_view const& UV, std::span<float> no_maps,
         render_settings<float> const& settings) {
    render(wrong, UV, {.settings = settings});
    render(phi, no_maps, {.settings = settings});
    render<no_method>(phi, UV, {.settings = settings});
    render(phi, UV, {.settings = render_settings<double>{}});
}
