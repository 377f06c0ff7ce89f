// SPDX-License-Identifier: MIT
// [GR sec. 4, tables 1 and 2, fig. 6] Every method, baseline, ablation and variant that is compared: one line each.
#pragma once

#include <genrender/baselines/baseline_settings.hpp>
#include <genrender/baselines/per_frame.hpp>
#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/pipeline/render.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace genrender::examples {

/// Settings of all rows.
using row_settings = render_settings<float>;

/// What denoises a row's frames.
enum class row_method { painted, generative_rendering, pix2video, tokenflow };

/// One row of the tables: a preset and what is changed of it.
struct compared_row {
    std::string name;                        ///< as the tables have it
    std::string group;                       ///< render, method, noise, ablation, texels or development
    row_method method;                       ///< what denoises its frames
    row_settings (*preset)() = nullptr;      ///< the settings that it begins with
    void (*change)(row_settings&) = nullptr; ///< what is different; none: nothing
};

/// What all rows of a run share, whatever their settings.
struct shared_settings {
    std::size_t steps = 20;
    std::size_t keyframes = 4;
    float sigma_min = 0.0292F;
    float sigma_max = 14.6146F;
    std::uint64_t seed = 0; ///< of noise and of keyframes
};

/// The settings of a row's run.
inline row_settings settings_of(compared_row const& row, shared_settings const& shared) {
    auto settings = row.preset();
    settings.steps = shared.steps;
    settings.sigma_min = shared.sigma_min;
    settings.sigma_max = shared.sigma_max;
    settings.noise.seed = shared.seed;
    settings.keyframes.seed = shared.seed;
    settings.keyframes.count = shared.keyframes;
    if (row.change != nullptr) {
        row.change(settings);
    }
    return settings;
}

// Presets.

/// The paper to the letter.
inline row_settings paper() { return row_settings::paper(); }
/// Alg. 1 with the defaults' readings, and nothing besides.
inline row_settings plain() { return row_settings::plain(); }
/// Consistent and vivid.
inline row_settings vivid() { return row_settings::vivid(); }
/// Per-Frame with independent noise, as the paper has it.
inline row_settings alone() { return per_frame(paper()); }
/// Per-Frame with one noise for all frames.
inline row_settings alone_fixed() { return per_frame(paper(), noise_kind::fixed); }
/// Per-Frame with noise that goes along with surfaces.
inline row_settings alone_uv() { return per_frame(vivid(), noise_kind::uv); }
/// A baseline with one noise for all frames, as the paper has it.
inline row_settings baseline_fixed() { return baseline_settings(paper()); }
/// A baseline with noise that goes along with surfaces: methods alone are compared.
inline row_settings baseline_uv() {
    auto settings = baseline_settings(paper(), noise_kind::uv);
    settings.noise.reading = vivid().noise.reading;
    return settings;
}

/// The same with the length-corrected temperature.
inline row_settings baseline_uv_corrected() {
    auto settings = baseline_uv();
    settings.injection.length_correction = 1;
    return settings;
}

// Changes.

/// Features by texels of a resolution; 0: matched to the maps.
template <std::size_t T>
void texels_of(row_settings& settings) {
    settings.correspondence.kind = correspondence_kind::texel_grid;
    settings.correspondence.texels.T = T > 0 ? std::optional(T) : std::nullopt;
}

/// Noise by texels of a resolution; 0: matched to the maps.
template <noise_reading Reading, std::size_t T>
void noise_texels_of(row_settings& settings) {
    settings.noise.reading = Reading;
    settings.noise.T = T > 0 ? std::optional(T) : std::nullopt;
}

/// The textured and lit surfaces themselves, which no method beats by right.
inline compared_row painted_row() { return {"Painted render", "render", row_method::painted}; }

/// All rows. A further one is a further line.
inline std::vector<compared_row> compared_rows() {
    using enum row_method;
    using s = row_settings;
    // clang-format off
    return {
        {"Per-Frame, independent noise", "method", generative_rendering, alone},
        {"Per-Frame, UV noise", "method", generative_rendering, alone_uv},
        {"Pix2Video*, fixed noise", "method", pix2video, baseline_fixed},
        {"Pix2Video*, UV noise", "method", pix2video, baseline_uv},
        {"TokenFlow*, fixed noise", "method", tokenflow, baseline_fixed},
        {"TokenFlow*, UV noise", "method", tokenflow, baseline_uv},
        {"Pix2Video*, UV noise, temperature", "method", pix2video, baseline_uv_corrected},
        {"TokenFlow*, UV noise, temperature", "method", tokenflow, baseline_uv_corrected},
        {"paper", "method", generative_rendering, paper},
        {"plain", "method", generative_rendering, plain},
        {"vivid", "method", generative_rendering, vivid},

        {"paper, no pre-attention", "ablation", generative_rendering, paper, [](s& x) { x.injection.pre_attention = false; }},
        {"paper, no post-attention", "ablation", generative_rendering, paper, [](s& x) { x.injection.post_attention = false; }},
        {"paper, no AdaIN", "ablation", generative_rendering, paper, [](s& x) { x.normalization.enabled = false; }},
        {"paper, fixed noise", "ablation", generative_rendering, paper, [](s& x) { x.noise.kind = noise_kind::fixed; }},
        {"paper, independent noise", "ablation", generative_rendering, paper, [](s& x) { x.noise.kind = noise_kind::independent; }},
        {"vivid, no pre-attention", "ablation", generative_rendering, vivid, [](s& x) { x.injection.pre_attention = false; }},
        {"vivid, no post-attention", "ablation", generative_rendering, vivid, [](s& x) { x.injection.post_attention = false; }},
        {"vivid, eq. 6 at the latents' grid too", "ablation", generative_rendering, vivid, [](s& x) { x.latents_grid_alpha = 1; }},
        {"vivid, no consensus", "ablation", generative_rendering, vivid, [](s& x) { x.consensus.enabled = false; }},
        {"vivid, no consensus of the background", "ablation", generative_rendering, vivid, [](s& x) { x.consensus.agrees_on_background = false; }},
        {"vivid, temperature", "ablation", generative_rendering, vivid, [](s& x) { x.injection.length_correction = 1; }},
        {"vivid, variance kept", "ablation", generative_rendering, vivid, [](s& x) { x.injection.variance.target = variance_target::sources; }},
        {"vivid, means normalised", "ablation", generative_rendering, vivid, [](s& x) { x.normalization.enabled = true; }},
        {"vivid, fixed noise", "ablation", generative_rendering, vivid, [](s& x) { x.noise.kind = noise_kind::fixed; }},
        {"vivid, plain average", "ablation", generative_rendering, vivid, [](s& x) { x.average = x.consensus.average = texel_average::plain; }},

        {"Per-Frame, fixed noise", "noise", generative_rendering, alone_fixed},
        {"vivid, independent noise", "noise", generative_rendering, vivid, [](s& x) { x.noise.kind = noise_kind::independent; }},
        {"vivid, independent background", "noise", generative_rendering, vivid, [](s& x) { x.noise.background = background_noise::independent; }},
        {"vivid, environment background", "noise", generative_rendering, vivid, [](s& x) { x.noise.background = background_noise::environment; }},
        {"vivid, nearest texel, T = 64", "noise", generative_rendering, vivid, noise_texels_of<noise_reading::nearest_texel, 64>},
        {"vivid, nearest texel, T = 256", "noise", generative_rendering, vivid, noise_texels_of<noise_reading::nearest_texel, 256>},
        {"vivid, nearest texel, T = 1024", "noise", generative_rendering, vivid, noise_texels_of<noise_reading::nearest_texel, 1024>},
        {"vivid, nearest texel, T = 4096", "noise", generative_rendering, vivid, noise_texels_of<noise_reading::nearest_texel, 4096>},
        {"vivid, nearest texel, T matched", "noise", generative_rendering, vivid, noise_texels_of<noise_reading::nearest_texel, 0>},
        {"vivid, bilinear texels, T matched", "noise", generative_rendering, vivid, noise_texels_of<noise_reading::bilinear_texel, 0>},

        {"vivid, features by texels, T = 64", "texels", generative_rendering, vivid, texels_of<64>},
        {"vivid, features by texels, T = 256", "texels", generative_rendering, vivid, texels_of<256>},
        {"vivid, features by texels, T = 1024", "texels", generative_rendering, vivid, texels_of<1024>},
        {"vivid, features by texels, T = 4096", "texels", generative_rendering, vivid, texels_of<4096>},
        {"vivid, features by texels, T matched", "texels", generative_rendering, vivid, texels_of<0>},

        {"no consensus", "development", generative_rendering, vivid, [](s& x) { x.consensus.enabled = false; }},
        {"no consensus of the background", "development", generative_rendering, vivid, [](s& x) { x.consensus.agrees_on_background = false; }},
        {"consensus in the first 40 %", "development", generative_rendering, vivid, [](s& x) { x.consensus.window_end = 0.4F; }},
        {"consensus in the first 60 %", "development", generative_rendering, vivid, [](s& x) { x.consensus.window_end = 0.6F; }},
        {"consensus in all steps", "development", generative_rendering, vivid, [](s& x) { x.consensus.window_end = 1; }},
        {"consensus to the silhouettes", "development", generative_rendering, vivid, [](s& x) { x.consensus.fades_at_silhouettes = false; }},
        {"consensus without variance", "development", generative_rendering, vivid, [](s& x) { x.consensus.most_gain = 1; }},
        {"consensus by quality cubed", "development", generative_rendering, vivid, [](s& x) { x.consensus.quality = {.exponent_begin = 3, .exponent_end = 3}; }},
        {"consensus by quality, 4 to 0", "development", generative_rendering, vivid, [](s& x) { x.consensus.quality = {.exponent_begin = 4, .exponent_end = 0}; }},
        {"consensus by quality, 8 to 1", "development", generative_rendering, vivid, [](s& x) { x.consensus.quality = {.exponent_begin = 8, .exponent_end = 1}; }},
        {"consensus by quality, 16 to 0", "development", generative_rendering, vivid, [](s& x) { x.consensus.quality = {.exponent_begin = 16, .exponent_end = 0}; }},
        {"consensus by quality, 16 to 0, temperature", "development", generative_rendering, vivid, [](s& x) { x.consensus.quality = {.exponent_begin = 16, .exponent_end = 0}; x.injection.length_correction = 1; }},
        {"consensus by plain average", "development", generative_rendering, vivid, [](s& x) { x.consensus.average = texel_average::plain; }},
        {"consensus of the best source", "development", generative_rendering, vivid, [](s& x) { x.consensus.average = texel_average::winner; }},
        {"eq. 6 at the latents' grid, .4", "development", generative_rendering, vivid, [](s& x) { x.latents_grid_alpha = 0.4F; }},
        {"eq. 6 at the latents' grid, 1", "development", generative_rendering, vivid, [](s& x) { x.latents_grid_alpha = 1; }},
        {"eq. 6 at the latents' grid, 1, temperature, variance", "development", generative_rendering, vivid, [](s& x) { x.latents_grid_alpha = 1; x.injection.length_correction = 1; x.injection.variance.target = variance_target::sources; }},
        {"no post-attention", "development", generative_rendering, vivid, [](s& x) { x.injection.post_attention = false; }},
        {"no pre-attention", "development", generative_rendering, vivid, [](s& x) { x.injection.pre_attention = false; }},
        {"temperature", "development", generative_rendering, vivid, [](s& x) { x.injection.length_correction = 1; }},
        {"points counted", "development", generative_rendering, vivid, [](s& x) { x.injection.counts_points = true; }},
        {"variance of sources", "development", generative_rendering, vivid, [](s& x) { x.injection.variance.target = variance_target::sources; }},
        {"held keyframes", "development", generative_rendering, vivid, [](s& x) { x.keyframes.drawing = keyframe_drawing::held; }},
        {"means normalised", "development", generative_rendering, vivid, [](s& x) { x.normalization.enabled = true; }},
        {"means of all frames", "development", generative_rendering, vivid, [](s& x) { x.normalization.enabled = true; x.normalization.target = adain_target::all_frames; }},
        {"supported deviations", "development", generative_rendering, vivid, [](s& x) { x.normalization.enabled = true; x.normalization.statistics = adain_statistics::mean_and_supported_deviation; }},
        {"mean and deviation", "development", generative_rendering, vivid, [](s& x) { x.normalization.enabled = true; x.normalization.statistics = adain_statistics::mean_and_deviation; }},
    };
    // clang-format on
}

/// The rows of the groups, in their order.
inline std::vector<compared_row> rows_of(std::vector<std::string> const& groups) {
    std::vector<compared_row> rows;
    for (auto const& row : compared_rows()) {
        if (std::find(groups.begin(), groups.end(), row.group) != groups.end()) {
            rows.push_back(row);
        }
    }
    return rows;
}

} // namespace genrender::examples
