// SPDX-License-Identifier: MIT
// A scene on the layered network with everything that an evaluation of a method refers to.
#pragma once

#include "../support/random_scene.hpp"
#include "layered_denoiser.hpp"

#include <genrender/correspondence/texel_grid.hpp>
#include <genrender/maps/background_mask.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/pipeline/sequence_denoiser.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace genrender::testing {

/// Three steps with two keyframes.
inline render_settings<double> few_steps() {
    render_settings<double> settings = render_settings<double>::plain();
    settings.steps = 3;
    settings.keyframes.count = 2;
    return settings;
}

/// Frames of three moving rectangles, textures of 10 x 10 texels, three steps.
template <class Real>
struct small_baseline_run {
    static constexpr std::size_t objects = 3;
    static constexpr std::size_t T = 10;
    std::size_t frames;
    uv_maps maps;
    layered_denoiser<Real> phi;
    render_settings<Real> settings = render_settings<Real>::plain();
    std::vector<Real> sigmas{8, 3, 1, 0};
    tensor<std::uint8_t, 3> background;
    correspondence_set<texel_grid> grids;
    sequential_loop loop;
    progress_meter meter{3, 1000, {}};
    render_report report;
    report_writer writer{report};

    explicit small_baseline_run(std::size_t frame_count = 6)
        : frames(frame_count), maps(random_scene(21, frame_count, {32, 32}, objects)),
          background(background_mask(to_uv_view(maps), layered_denoiser<Real>::grid)) {
        settings.steps = 3;
        settings.keyframes.count = std::min<std::size_t>(3, frames);
        settings.normalization.enabled = false;
        for (auto const grid : {phi.grid, phi.coarse}) {
            grids.add(grid, [&](grid_extents g) { return texel_grid(to_uv_view(maps), g, {.T = T}); });
        }
    }

    latents<Real> noise() const {
        auto z = latents<Real>::from_shape({frames, 3, 8, 8});
        for (std::size_t e = 0; e < z.size(); ++e) {
            z.data()[e] =
                static_cast<Real>(3 * normal_value(5, random_stream::test, {static_cast<std::uint32_t>(e), 0, 0}));
        }
        return z;
    }

    /// The clean estimates of a method.
    template <class Method>
    latents<Real> estimate(Method const& method, latents<Real> const& z, Real sigma) {
        return sequence_denoiser(phi, grids, to_view(std::as_const(background)), std::span<Real const>(sigmas),
                                 settings, loop, meter, writer, method)(z, sigma);
    }
};

/// The greatest difference between latents and a stack in frame i.
template <class Real>
double frame_difference(latents<Real> const& a, strided_view<Real const, 4> b, std::size_t i) {
    auto const values = a.size() / a.shape()[0];
    double worst = 0;
    for (std::size_t e = i * values; e < (i + 1) * values; ++e) {
        worst = std::max(worst, std::abs(static_cast<double>(a.data()[e]) - static_cast<double>(b.data()[e])));
    }
    return worst;
}

/// Bound of rounding in three layers that amplify it.
template <class Real>
constexpr double layered_tolerance = sizeof(Real) == 4 ? 1e-4 : 3e-13;

} // namespace genrender::testing
