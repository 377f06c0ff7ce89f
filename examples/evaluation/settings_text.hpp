// SPDX-License-Identifier: MIT
// All settings that change the frames of a run as a text: what results are kept by.
#pragma once

#include "methods.hpp"

#include <genrender/attention/attention_site.hpp>
#include <genrender/pipeline/render_settings.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace genrender::examples {

namespace detail {

/// Lines `name = value`.
class settings_writer {
public:
    settings_writer() { text_.precision(9); }

    template <class T>
    void operator()(char const* name, T const& value) {
        text_ << name << " = ";
        put(value);
        text_ << '\n';
    }
    std::string text() const { return text_.str(); }

private:
    template <class T>
    void put(T const& value) {
        if constexpr (std::is_enum_v<T>) {
            text_ << static_cast<long>(value);
        } else {
            text_ << value;
        }
    }
    template <class T>
    void put(std::optional<T> const& value) {
        value ? put(*value) : void(text_ << "none");
    }
    void put(frame_index value) { text_ << value.value; }
    template <class T>
    void put(std::vector<T> const& values) {
        for (auto const& value : values) {
            put(value);
            text_ << ' ';
        }
    }

    std::ostringstream text_;
};

} // namespace detail

/// Every setting of a run that its frames depend on, a line each; those that only cost memory or time are left out. What
/// functions give is asked for at `sites` and in `branches` guidance branches. A setting that is added to the library and
/// not named here does not compile, so that no result is kept under a key that does not know it.
inline std::string settings_text(row_settings const& settings, std::vector<attention_site> const& sites,
                                 std::uint32_t branches) {
    detail::settings_writer write;
    auto const& [steps, sigma_min, sigma_max, rho, sampler, noise, keyframes, correspondence, consensus, normalization,
                 layers, alpha, latents_grid_alpha, injection, first_fill_share, average, quality, window_begin,
                 window_end, keyframe_storage, reuses_keyframes, frames_per_call, fills_last_call, calls_at_once] =
        settings;
    static_cast<void>(reuses_keyframes); // frames are the same to the bit
    static_cast<void>(frames_per_call);
    static_cast<void>(fills_last_call);
    static_cast<void>(calls_at_once);
    write("steps", steps);
    write("sigma_min", sigma_min);
    write("sigma_max", sigma_max);
    write("rho", rho);
    write("sampler", sampler);
    write("first_fill_share", first_fill_share);
    write("average", average);
    write("latents_grid_alpha", latents_grid_alpha);
    write("window_begin", window_begin);
    write("window_end", window_end);
    write("keyframe_storage", keyframe_storage);
    {
        auto const& [kind, background, T, seed, reading, rays] = noise;
        write("noise.kind", kind);
        write("noise.background", background);
        write("noise.T", T);
        write("noise.seed", seed);
        write("noise.reading", reading);
        static_cast<void>(rays); // the scene's own
    }
    {
        auto const& [count, drawing, frames, seed] = keyframes;
        write("keyframes.count", count);
        write("keyframes.drawing", drawing);
        write("keyframes.frames", frames);
        write("keyframes.seed", seed);
    }
    {
        auto const& [kind, footprint, texels] = correspondence;
        auto const& [reach, match_cache_bytes, cached_frames] = footprint;
        auto const& [T, reading, dilation] = texels;
        static_cast<void>(match_cache_bytes);
        static_cast<void>(cached_frames);
        write("correspondence.kind", kind);
        write("correspondence.footprint.reach", reach);
        write("correspondence.texels.T", T);
        write("correspondence.texels.reading", reading);
        write("correspondence.texels.dilation", dilation);
    }
    {
        auto const& [enabled, begin, end, strength, sources, first_fill, sources_average, sources_quality, most_gain,
                     fades, on_background, distance] = consensus;
        auto const& [count, drawing, frames, seed] = sources;
        write("consensus.enabled", enabled);
        write("consensus.window_begin", begin);
        write("consensus.window_end", end);
        std::vector<float> strengths;
        for (std::size_t step = 0; step < steps; ++step) {
            strengths.push_back(strength(step));
        }
        write("consensus.strength", strengths);
        write("consensus.sources.count", count);
        write("consensus.sources.drawing", drawing);
        write("consensus.sources.frames", frames);
        write("consensus.sources.seed", seed);
        write("consensus.first_fill_share", first_fill);
        write("consensus.average", sources_average);
        write("consensus.most_gain", most_gain);
        write("consensus.fades_at_silhouettes", fades);
        write("consensus.agrees_on_background", on_background);
        write("consensus.background_distance", distance);
        write("consensus.quality.exponent_begin", sources_quality.exponent_begin);
        write("consensus.quality.exponent_end", sources_quality.exponent_end);
        write("consensus.quality.threshold", sources_quality.threshold);
    }
    {
        auto const& [exponent_begin, exponent_end, threshold] = quality;
        write("quality.exponent_begin", exponent_begin);
        write("quality.exponent_end", exponent_end);
        write("quality.threshold", threshold);
    }
    {
        auto const& [enabled, statistics, target, begin, end, least_pixels, fallback, on_noisy_latents,
                     enough_background, standard_errors, most_gain, band_levels] = normalization;
        write("normalization.enabled", enabled);
        write("normalization.statistics", statistics);
        write("normalization.target", target);
        write("normalization.enough_background", enough_background);
        write("normalization.standard_errors", standard_errors);
        write("normalization.most_gain", most_gain);
        write("normalization.band_levels", band_levels);
        write("normalization.window_begin", begin);
        write("normalization.window_end", end);
        write("normalization.least_pixels", least_pixels);
        write("normalization.fallback", fallback);
        write("normalization.on_noisy_latents", on_noisy_latents);
    }
    {
        auto const& [pre_attention, post_attention, keeps_own_copy, length_correction, counts_points, variance] =
            injection;
        write("injection.length_correction", length_correction);
        write("injection.counts_points", counts_points);
        write("injection.variance.target", variance.target);
        write("injection.variance.most_gain", variance.most_gain);
        write("injection.pre_attention", pre_attention);
        write("injection.post_attention", post_attention);
        write("injection.keeps_own_copy", keeps_own_copy);
    }
    for (auto const& site : sites) {
        std::vector<bool> takes_part;
        std::vector<float> alphas;
        for (std::uint32_t branch = 0; branch < branches; ++branch) {
            takes_part.push_back(layers(site, branch));
        }
        for (std::size_t step = 0; step < steps; ++step) {
            alphas.push_back(alpha(step, site));
        }
        write(("layers of " + site.name).c_str(), takes_part);
        write(("alpha of " + site.name).c_str(), alphas);
    }
    return write.text();
}

} // namespace genrender::examples
