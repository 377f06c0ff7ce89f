// SPDX-License-Identifier: MIT
// [GR sec. 3.3, alg. 1: z_T] Initial latents before scaling: UV noise, and the paper's ablations of it.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/instance.hpp>
#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/surface_sample.hpp>
#include <genrender/noise/background_noise.hpp>
#include <genrender/noise/noise_texture.hpp>
#include <genrender/noise/surface_noise.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace genrender {

/// Which initial noise the frames start from.
enum class noise_kind : std::uint8_t {
    uv,         ///< projected from a noise texture: moves with the surfaces (the paper's method)
    fixed,      ///< one image for all frames: sticks to the screen (ablation)
    independent ///< another image for each frame (ablation, and plain per-frame sampling)
};

/// How a latent pixel reads the noise of a surface under noise_kind::uv.
enum class noise_reading : std::uint8_t {
    surface,       ///< all of the surface that the pixel sees, at any zoom: white in every frame (surface_noise)
    nearest_texel, ///< one texel of a T x T texture: the paper's, with values that repeat or do not correspond
    bilinear_texel ///< the four texels around a point, mixed: loses variance, to compare with
};

/// How initial noise is made.
struct noise_settings {
    noise_kind kind = noise_kind::uv;                      ///< which noise the frames start from
    background_noise background = background_noise::fixed; ///< which noise pixels without an object get
    /// T, texels along each side of an object's noise texture under the readings of texels: a low T repeats
    /// values in neighbouring pixels, a high T gives each frame noise of its own. None matches each object's T to its
    /// density in the maps, one texel a latent pixel.
    std::optional<std::size_t> T{};
    std::uint64_t seed = 0;                         ///< two runs of one seed have the same noise
    noise_reading reading = noise_reading::surface; ///< how a latent pixel reads the noise of a surface
    environment_rays rays = {};                     ///< what background_noise::environment needs
};

namespace detail {

/// The mean of the four texels around a sample, by its distance from their centres.
inline double bilinear_value(noise_texture const& z_UV, surface_sample const& sample,
                             texture_resolution const& resolution, std::uint32_t channel) {
    auto const T = static_cast<double>(resolution.of(sample.object));
    auto const low = [T](float coordinate) { return std::floor(static_cast<double>(coordinate) * T - 0.5); };
    auto const column = low(sample.uv[0]);
    auto const row = low(sample.uv[1]);
    double value = 0;
    for (auto const down : {0.0, 1.0}) {
        for (auto const right : {0.0, 1.0}) {
            auto const share = (1 - std::abs(static_cast<double>(sample.uv[0]) * T - 0.5 - column - right)) *
                               (1 - std::abs(static_cast<double>(sample.uv[1]) * T - 0.5 - row - down));
            auto const inside = [T](double place) { return static_cast<std::uint32_t>(std::clamp(place, 0.0, T - 1)); };
            value += share * z_UV({sample.object, inside(row + down), inside(column + right)}, channel);
        }
    }
    return value;
}

/// z = pi_UV(z_UV) of a stored-resolution texture: every latent pixel reads where its representative sample lies.
template <class Real>
void texel_noise(strided_view<Real, 3> z, uv_maps_view const& maps, frame_index i, texture_resolution const& resolution,
                 noise_settings const& settings) {
    grid_extents const grid{z.extent(1), z.extent(2)};
    noise_texture const z_UV{settings.seed};
    for (std::uint32_t t = 0; t < grid.size(); ++t) {
        auto const sample = representative_sample(maps, i, grid, {t});
        // Refuses coordinates that are no numbers, whatever the reading.
        auto const nearest = sample ? texel_of(*sample, resolution) : texel{};
        for (std::uint32_t c = 0; c < z.extent(0); ++c) {
            auto const value = !sample ? screen_noise(settings.seed, settings.background, i, 0, t, c)
                               : settings.reading == noise_reading::nearest_texel
                                   ? z_UV(nearest, c)
                                   : bilinear_value(z_UV, *sample, resolution, c);
            z(c, t / grid.width, t % grid.width) = static_cast<Real>(value);
        }
    }
}

/// Throws value_error for settings that contradict each other.
inline void require_noise_settings(noise_settings const& settings) {
    auto const has_texels = settings.reading != noise_reading::surface;
    require_value(!settings.T || has_texels, "initial_noise", "settings.T", settings.T.value_or(0),
                  "none, since noise_reading::surface has no texture resolution");
    require_value(settings.background != background_noise::environment || (!has_texels && settings.rays.direction),
                  "initial_noise", "settings.background", "environment",
                  "noise_reading::surface and settings.rays beside it");
}

} // namespace detail

/// Writes noise of N(0, 1) into z [frames, channels, height, width]; `frames[i]` is the frame that entry i shows. Under
/// noise_kind::uv, z = pi_UV(z_UV) by settings.reading. Each frame depends on its own maps alone, and without T
/// under readings of texels on the T that all frames of the maps give its objects. Throws shape_error if `frames` does not
/// count the entries of z, value_error if a frame is not in the maps, the latents do not divide them, a coordinate is
/// not finite, or settings contradict each other or, with texels, the maps are not UV maps.
template <class Real, canonical_maps Maps>
void initial_noise(strided_view<Real, 4> z, Maps const& maps, std::span<frame_index const> frames,
                   noise_settings const& settings, any_loop const& loop = {}) {
    require_extents("initial_noise", "frames", std::array{frames.size()}, std::array{z.extent(0)});
    grid_extents const grid{z.extent(2), z.extent(3)};
    cell_extents("initial_noise", maps.grid(), grid);
    for (auto const frame : frames) {
        require_value(frame.value < maps.frame_count(), "initial_noise", "frames", frame.value,
                      "frames of the UV maps");
    }
    detail::require_noise_settings(settings);
    if (settings.kind != noise_kind::uv) {
        auto const kind = settings.kind == noise_kind::fixed ? background_noise::fixed : background_noise::independent;
        loop(frames.size(), [&](std::size_t i) {
            for (std::uint32_t t = 0; t < grid.size(); ++t) {
                for (std::uint32_t c = 0; c < z.extent(1); ++c) {
                    z(i, c, t / grid.width, t % grid.width) =
                        static_cast<Real>(screen_noise(settings.seed, kind, frames[i], 0, t, c));
                }
            }
        });
    } else if (settings.reading == noise_reading::surface) {
        loop(frames.size(), [&](std::size_t i) {
            surface_noise(z[i], maps, frames[i], settings.seed, settings.background, settings.rays);
        });
    } else if constexpr (std::same_as<Maps, uv_maps_view>) {
        auto const resolution =
            settings.T ? texture_resolution::same(*settings.T) : texture_resolution::matched(maps, grid, 1);
        loop(frames.size(), [&](std::size_t i) { detail::texel_noise(z[i], maps, frames[i], resolution, settings); });
    } else {
        throw value_error(
            "initial_noise: settings.reading is of texels, expected surface for maps that are not UV maps");
    }
}

GENRENDER_INSTANCE(initial_noise<float, uv_maps_view>);
GENRENDER_INSTANCE(initial_noise<double, uv_maps_view>);

} // namespace genrender

#include <genrender/core/end_header.inl>
