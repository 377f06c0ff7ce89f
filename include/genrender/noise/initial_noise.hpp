// SPDX-License-Identifier: MIT
// [GR sec. 3.3, alg. 1: z_T] Initial latents before scaling: UV noise, and the paper's ablations of it.
#pragma once

#include <genrender/core/parallel.hpp>
#include <genrender/correspondence/surface_sample.hpp>
#include <genrender/noise/noise_texture.hpp>

#include <array>
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

/// Which noise pixels without an object receive under noise_kind::uv.
enum class background_noise : std::uint8_t {
    fixed,      ///< one image for all frames
    independent ///< another image for each frame
};

/// How initial noise is made.
struct noise_settings {
    noise_kind kind = noise_kind::uv;
    background_noise background = background_noise::fixed;
    /// T, texels along each side of an object's noise texture, which is read by the nearest texel: a low T repeats
    /// values in neighbouring pixels, a high T gives each frame noise of its own. 0 matches each object's T to its
    /// density in the maps, one texel a latent pixel.
    std::size_t T = 0;
    std::uint64_t seed = 0;
};

/// Writes noise of N(0, 1) into z [frames, channels, height, width]; `frames[i]` is the frame that entry i shows. Under
/// noise_kind::uv, z = pi_UV(z_UV): a latent pixel reads the texel of its representative sample. Each frame depends on
/// its own maps alone, and with T = 0 on the T that all frames of the maps give its objects. Throws shape_error if
/// `frames` does not count the entries of z, value_error if a frame is not in the maps, the latents do not divide them
/// or a UV is not finite.
template <class Real, parallel_loop Loop = sequential_loop>
void initial_noise(strided_view<Real, 4> z, uv_maps_view const& maps, std::span<frame_index const> frames,
                   noise_settings const& settings, Loop const& loop = {}) {
    require_extents("initial_noise", "frames", std::array{frames.size()}, std::array{z.extent(0)});
    grid_extents const grid{z.extent(2), z.extent(3)};
    cell_extents("initial_noise", maps.grid(), grid);
    for (auto const frame : frames) {
        require_value(frame.value < maps.frame_count(), "initial_noise", "frames", frame.value,
                      "frames of the UV maps");
    }
    auto const resolution = settings.kind != noise_kind::uv ? texture_resolution::same(1) // No texture is read.
                            : settings.T > 0                ? texture_resolution::same(settings.T)
                                                            : texture_resolution::matched(maps, grid, 1);
    noise_texture const z_UV{settings.seed};
    auto const differs_by_frame =
        settings.kind == noise_kind::independent ||
        (settings.kind == noise_kind::uv && settings.background == background_noise::independent);

    loop(frames.size(), [&](std::size_t i) {
        for (std::uint32_t t = 0; t < grid.size(); ++t) {
            auto const sample =
                settings.kind == noise_kind::uv ? representative_sample(maps, frames[i], grid, {t}) : std::nullopt;
            for (std::uint32_t c = 0; c < z.extent(1); ++c) {
                auto const value =
                    sample ? z_UV(texel_of(*sample, resolution), c)
                    : differs_by_frame
                        ? normal_value(settings.seed, random_stream::frame_noise, {frames[i].value, t, c})
                        : normal_value(settings.seed, random_stream::background_noise, {0, t, c});
                z(i, c, t / grid.width, t % grid.width) = static_cast<Real>(value);
            }
        }
    });
}

} // namespace genrender
