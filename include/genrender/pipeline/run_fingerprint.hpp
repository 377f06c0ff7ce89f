// SPDX-License-Identifier: MIT
// What tells runs apart whose frames differ: fingerprints of settings, maps and model.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/fingerprint.hpp>
#include <genrender/core/index.hpp>
#include <genrender/maps/canonical_maps.hpp>
#include <genrender/pipeline/render_settings.hpp>
#include <genrender/sampling/denoiser.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <string_view>

namespace genrender {

/// Runs with equal ones give the same frames, as far as the library can know of the model.
struct run_fingerprint {
    std::uint64_t settings = 0; ///< settings and method, and what settings' functions say of each step and site
    std::uint64_t maps = 0;     ///< extents of the maps, and object and surface point of every pixel
    std::uint64_t model = 0;    ///< latents, sites and branches of the denoiser, and what the caller names it by
    /// Equal in all three.
    friend bool operator==(run_fingerprint const&, run_fingerprint const&) = default;
};

namespace detail {

/// What the compiler calls a type.
template <class T>
constexpr std::string_view type_text() {
#if defined(_MSC_VER) && !defined(__clang__)
    return __FUNCSIG__;
#else
    return __PRETTY_FUNCTION__;
#endif
}

// Every member is bound by name, so that a new one does not compile until somebody has decided on it. What is bound and
// left out does not change frames.
inline void add_settings(fingerprint& to, keyframe_settings const& of) {
    auto const& [count, drawing, frames, seed] = of;
    to.add(count);
    to.add(drawing);
    to.add(frames.size());
    for (auto const frame : frames) {
        to.add(frame.value);
    }
    to.add(seed);
}

inline void add_settings(fingerprint& to, quality_settings const& of) {
    auto const& [exponent_begin, exponent_end, threshold] = of;
    to.add(exponent_begin);
    to.add(exponent_end);
    to.add(threshold);
}

inline void add_settings(fingerprint& to, noise_settings const& of, std::size_t frames, grid_extents grid) {
    auto const& [kind, background, T, seed, reading, rays] = of;
    to.add(kind);
    to.add(background);
    to.add(T);
    to.add(seed);
    to.add(reading);
    for (std::uint32_t i = 0; background == background_noise::environment && rays.direction && i < frames; ++i) {
        // A camera's directions are told by those of three corners.
        for (auto const corner : {std::array{0.0, 0.0}, std::array{0.0, 1.0}, std::array{1.0, 0.0}}) {
            auto const direction = rays.direction({i}, corner[0] * static_cast<double>(grid.height),
                                                  corner[1] * static_cast<double>(grid.width));
            for (auto const component : direction) {
                to.add(component);
            }
        }
    }
}

inline void add_settings(fingerprint& to, correspondence_settings const& of) {
    auto const& [kind, footprint, texels] = of;
    auto const& [reach, match_cache_bytes, cached_frames] = footprint;
    auto const& [T, reading, dilation] = texels;
    to.add(kind);
    to.add(reach);
    to.add(T);
    to.add(reading);
    to.add(dilation);
}

template <class Real>
void add_settings(fingerprint& to, consensus_settings<Real> const& of, std::size_t steps) {
    auto const& [enabled, window_begin, window_end, strength, sources, first_fill_share, average, quality, most_gain,
                 fades_at_silhouettes, agrees_on_background, background_distance] = of;
    to.add(enabled);
    to.add(window_begin);
    to.add(window_end);
    for (std::size_t step = 0; step < steps; ++step) {
        to.add(strength(step));
    }
    add_settings(to, sources);
    to.add(first_fill_share);
    to.add(average);
    add_settings(to, quality);
    to.add(most_gain);
    to.add(fades_at_silhouettes);
    to.add(agrees_on_background);
    to.add(background_distance);
}

template <class Real>
void add_settings(fingerprint& to, adain_settings<Real> const& of) {
    auto const& [enabled, statistics, target, window_begin, window_end, least_pixels, fallback, on_noisy_latents,
                 enough_background, standard_errors, most_gain, band_levels] = of;
    to.add(enabled);
    to.add(statistics);
    to.add(target);
    to.add(window_begin);
    to.add(window_end);
    to.add(least_pixels);
    to.add(fallback);
    to.add(on_noisy_latents);
    to.add(enough_background);
    to.add(standard_errors);
    to.add(most_gain);
    to.add(band_levels);
}

inline void add_settings(fingerprint& to, injection_settings const& of) {
    auto const& [pre_attention, post_attention, keeps_own_copy, length_correction, counts_points, variance] = of;
    auto const& [target, most_gain] = variance;
    to.add(pre_attention);
    to.add(post_attention);
    to.add(keeps_own_copy);
    to.add(length_correction);
    to.add(counts_points);
    to.add(target);
    to.add(most_gain);
}

} // namespace detail

/// Of settings and a method, for a denoiser and maps of so many frames. How frames are shared among calls is no part of
/// it: by the laws of a denoiser it does not change them, and who ran out of memory goes on with fewer a call. A method
/// is told by its type and the keyframes that it names; what else its members decide belongs to the model's key. `Map` is
/// told by its type alone. Throws as the method's keyframes do.
template <class Map, denoiser Phi, class Real, class Method>
std::uint64_t fingerprint_of_settings(Phi const& phi, render_settings<Real> const& settings, Method const& method,
                                      std::size_t frames, grid_extents grid) {
    auto const& [steps, sigma_min, sigma_max, rho, sampler, noise, keyframes, correspondence, consensus, normalization,
                 layers, alpha, latents_grid_alpha, injection, first_fill_share, average, quality, window_begin,
                 window_end, keyframe_storage, reuses_keyframes, frames_per_call, fills_last_call, calls_at_once] =
        settings;
    fingerprint to;
    to.add(steps);
    to.add(sigma_min);
    to.add(sigma_max);
    to.add(rho);
    to.add(sampler);
    detail::add_settings(to, noise, frames, grid);
    detail::add_settings(to, keyframes);
    detail::add_settings(to, correspondence);
    detail::add_settings(to, consensus, steps);
    detail::add_settings(to, normalization);
    auto const& sites = phi.sites();
    for (std::uint32_t site = 0; site < std::ranges::size(sites); ++site) {
        for (std::uint32_t branch = 0; branch < phi.branches(); ++branch) {
            auto const takes_part = layers(sites[site], branch);
            to.add(takes_part);
            for (std::size_t step = 0; takes_part && step < steps; ++step) {
                to.add(alpha(step, sites[site]));
            }
        }
    }
    to.add(latents_grid_alpha);
    detail::add_settings(to, injection);
    to.add(first_fill_share);
    to.add(average);
    detail::add_settings(to, quality);
    to.add(window_begin);
    to.add(window_end);
    to.add(keyframe_storage);
    to.add(detail::type_text<Method>());
    to.add(detail::type_text<Map>());
    for (std::size_t step = 0; step < steps; ++step) {
        for (auto const frame : method.keyframes(settings, frames, step)) {
            to.add(frame.value);
        }
    }
    return to.value();
}

/// Of maps. Reads each pixel once; what uncovered ones hold is no part of it.
template <canonical_maps Maps>
std::uint64_t fingerprint_of_maps(Maps const& maps) {
    fingerprint to;
    auto const grid = grid_extents(maps.grid());
    to.add(std::size_t{Maps::dimensions});
    to.add(std::size_t{maps.frame_count()});
    to.add(grid.height);
    to.add(grid.width);
    std::uint64_t uncovered = 0; // in a row, taken in as one number
    for (std::uint32_t i = 0; i < maps.frame_count(); ++i) {
        for (std::uint32_t row = 0; row < grid.height; ++row) {
            for (std::uint32_t column = 0; column < grid.width; ++column) {
                if (!maps.is_covered({i}, {row, column})) {
                    ++uncovered;
                    continue;
                }
                to.add(uncovered);
                uncovered = 0;
                to.add(maps.object_at({i}, {row, column}).value);
                for (auto const coordinate : maps.point_at({i}, {row, column})) {
                    to.add(coordinate);
                }
            }
        }
    }
    to.add(uncovered);
    return to.value();
}

/// Of a denoiser, as far as it tells of itself, and of `key`, by which the caller names what it does not tell: its weights,
/// prompt and depth.
template <denoiser Phi>
std::uint64_t fingerprint_of_model(Phi const& phi, std::string_view key) {
    fingerprint to;
    auto const grid = grid_extents(phi.latent_grid());
    to.add(sizeof(typename Phi::real_type));
    to.add(std::size_t{phi.latent_channels()});
    to.add(grid.height);
    to.add(grid.width);
    to.add(std::size_t{phi.branches()});
    for (attention_site const& site : phi.sites()) {
        to.add(std::string_view(site.name));
        to.add(site.network);
        to.add(site.part);
        to.add(site.grid.height);
        to.add(site.grid.width);
        to.add(site.channels);
    }
    to.add(key);
    return to.value();
}

/// Of a run, whose correspondence maps are of type `Map`. Throws as fingerprint_of_settings does.
template <class Map, denoiser Phi, canonical_maps Maps, class Real, class Method>
run_fingerprint fingerprint_of(Phi const& phi, Maps const& maps, render_settings<Real> const& settings,
                               Method const& method, std::string_view key) {
    return {fingerprint_of_settings<Map>(phi, settings, method, maps.frame_count(), maps.grid()),
            fingerprint_of_maps(maps), fingerprint_of_model(phi, key)};
}

} // namespace genrender

#include <genrender/core/end_header.inl>
