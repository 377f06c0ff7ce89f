// SPDX-License-Identifier: MIT
// render() with what is no denoiser, what are no maps, settings of another scalar and what is no correspondence.
// expected: denoiser: branches() is const and returns the number of guidance branches
// expected: canonical_maps: maps can be copied and have dimensions
// expected: render: settings are render_settings<Real> with the real_type of the denoiser
// expected: correspondence_map: point_type is a copyable type
#include "right_models.hpp"

#include <genrender/pipeline/render.hpp>

using namespace genrender;

struct without_branches : right_denoiser {
    void branches() const;
};

void run(without_branches const& wrong, right_denoiser const& phi, uv_maps_view const& UV, std::span<float> no_maps,
         render_settings<float> const& settings, render_report& report) {
    render(wrong, UV, settings, report);
    render(generative_rendering{}, wrong, UV, settings, report);
    render(phi, no_maps, settings, report);
    render(phi, UV, render_settings<double>{}, report);
    auto const make_number = [](grid_extents) { return 3; };
    render(phi, UV, make_number, settings, report);
}
