// SPDX-License-Identifier: MIT
// [GR alg. 1] Generative Rendering: from the UV maps of an animated scene to consistent latents, with the user's
// denoiser.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/core/finite.hpp>
#include <genrender/maps/background_mask.hpp>
#include <genrender/pipeline/sequence_denoiser.hpp>
#include <genrender/sampling/karras_schedule.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace genrender {

/// Throws value_error for settings that no run could honour.
template <class Real>
void require_render_settings(render_settings<Real> const& settings, std::size_t frames) {
    require_value(frames > 0, "render", "UV.frame_count()", frames, "at least one frame");
    require_value(settings.steps > 0, "render", "settings.steps", settings.steps, "at least one step");
    require_value(settings.frames_per_call > 0, "render", "settings.frames_per_call", settings.frames_per_call,
                  "at least one frame");
    auto const require_window = [](char const* argument, Real begin, Real end) {
        if (!(begin >= 0 && end <= 1 && begin <= end)) {
            throw value_error(std::string("render: ") + argument + " is [" + std::to_string(begin) + ", " +
                              std::to_string(end) + "), expected 0 <= begin <= end <= 1");
        }
    };
    require_window("window of settings", settings.window_begin, settings.window_end);
    require_window("window of settings.normalization", settings.normalization.window_begin,
                   settings.normalization.window_end);
    require_value(settings.first_fill_share >= 0 && settings.first_fill_share <= 1, "render",
                  "settings.first_fill_share", settings.first_fill_share, "a share in [0, 1]");
    require_value(settings.layers != nullptr, "render", "settings.layers", "empty", "a function");
    require_value(settings.alpha != nullptr, "render", "settings.alpha", "empty", "a function");
    evaluations(settings.sampler, settings.steps);
}

/// Throws value_error naming the first covered pixel whose canonical coordinates are not finite.
template <canonical_maps Maps>
void require_finite_coordinates(Maps const& UV) {
    for (std::uint32_t frame = 0; frame < UV.frame_count(); ++frame) {
        for (std::uint32_t row = 0; row < UV.grid().height; ++row) {
            for (std::uint32_t column = 0; column < UV.grid().width; ++column) {
                if (!UV.is_covered({frame}, {row, column})) {
                    continue;
                }
                for (auto const coordinate : UV.point_at({frame}, {row, column})) {
                    if (!is_finite(coordinate)) {
                        throw value_error("render: UV of frame " + std::to_string(frame) + " at row " +
                                          std::to_string(row) + " column " + std::to_string(column) + " is " +
                                          std::to_string(coordinate) + ", expected finite texture coordinates");
                    }
                }
            }
        }
    }
}

/// Number of frames that a run of `frames` frames by a method gives to the denoiser in all its evaluations, keyframes
/// counted anew in each step that has them. Throws value_error if a step's keyframes cannot be drawn.
template <class Real, class Method = generative_rendering>
std::size_t frames_to_denoise(render_settings<Real> const& settings, std::size_t frames, Method const& method = {}) {
    std::size_t total = 0;
    for (std::size_t step = 0; step < settings.steps; ++step) {
        // Heun's second evaluation is at the level at which the next step begins.
        auto const evaluations = settings.sampler == sampler_kind::heun && step > 0 ? 2U : 1U;
        total += evaluations * (frames + method.keyframes(settings, frames, step).size());
    }
    return total;
}

/// The correspondence map that `make_map(grid)` compiles.
template <class MakeMap>
using map_made_by = std::invoke_result_t<MakeMap const&, grid_extents>;

/// Renders an animation by a method with a denoiser: z_0 [frames, channels, height, width], the clean latents of all
/// frames, for the user's decoder. UV maps [frames, height, width] are of full resolution, a whole multiple of the
/// denoiser's latent grid and feature grids; the denoiser owns prompt and depth. `make_map(grid)` compiles the
/// correspondence map of a feature resolution. The same seeds give the same frames with every `loop`, bit for bit.
/// Throws value_error or shape_error for arguments that do not fit, before anything is run; cancelled if the observer
/// ends the run; what the denoiser throws.
template <denoiser Phi, canonical_maps Maps, class MakeMap,
          sequence_method<sequence_passes<Phi, map_made_by<MakeMap>>> Method>
latents<typename Phi::real_type> render(Method const& method, Phi const& phi, Maps const& UV, MakeMap const& make_map,
                                        render_settings<typename Phi::real_type> const& settings, render_report& report,
                                        progress_observer observer = {}, any_loop const& loop = {}) {
    using Real = typename Phi::real_type;
    require_render_settings(settings, UV.frame_count());
    require_finite_coordinates(UV);
    auto const sigmas = karras_schedule<Real>(settings.steps, settings.sigma_min, settings.sigma_max, settings.rho);
    auto const N = UV.frame_count();
    auto const grid = grid_extents(phi.latent_grid());
    auto const total = frames_to_denoise(settings, N, method);

    auto const start = std::chrono::steady_clock::now();
    report.set_vector_target(chosen_vector_target());

    // z_UV ~ N(0, I); z = z_T = sigma_T pi_UV(z_UV)
    auto z = latents<Real>::from_shape({N, phi.latent_channels(), grid.height, grid.width});
    std::vector<frame_index> frames;
    for (std::uint32_t i = 0; i < N; ++i) {
        frames.push_back({i});
    }
    initial_noise(to_view(z), UV, frames, settings.noise, loop);
    z *= sigmas.front();

    // Compile what geometry decides, once for the animation.
    auto const background = background_mask(UV, grid);
    correspondence_set<map_made_by<MakeMap>> maps;
    for (auto const& site : phi.sites()) {
        for (std::uint32_t branch = 0; branch < phi.branches(); ++branch) {
            if (!method.uses_correspondence(settings) || !settings.layers(site, branch)) {
                continue;
            }
            for (std::size_t step = 0; step < settings.steps; ++step) {
                auto const alpha = settings.alpha(step, site);
                require_value(is_finite(alpha), "render", "settings.alpha", alpha, "finite numbers");
            }
            maps.add(site.grid, make_map);
        }
    }

    report.add_seconds(0, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());

    // for t = T, ..., 1: what the method does, for alg. 1 keyframes, features, blending and injection; normalisation
    progress_meter meter(settings.steps, total, std::move(observer));
    sequence_denoiser const D(phi, maps, to_view(background), std::span<Real const>(sigmas), settings, loop, meter,
                              report, method);
    // Samplers are compiled once for all networks, maps and methods.
    std::function<latents<Real>(latents<Real> const&, Real)> const denoise = std::cref(D);
    std::function<void(std::size_t, latents<Real>&)> const normalize = [&](std::size_t step, latents<Real>& z_next) {
        if (settings.normalization.enabled && settings.normalization.on_noisy_latents) {
            D.normalize(z_next, step);
        }
    };
    return sample(settings.sampler, denoise, std::move(z), sigmas, normalize);
}

/// The same with the correspondence that `settings.correspondence` chooses.
template <denoiser Phi, canonical_maps Maps,
          sequence_method<sequence_passes<Phi, chosen_correspondence<Maps::dimensions>>> Method>
latents<typename Phi::real_type> render(Method const& method, Phi const& phi, Maps const& UV,
                                        render_settings<typename Phi::real_type> const& settings, render_report& report,
                                        progress_observer observer = {}, any_loop const& loop = {}) {
    auto const make_map = [&](grid_extents grid) {
        return chosen_correspondence<Maps::dimensions>(UV, grid, settings.correspondence, loop);
    };
    return render(method, phi, UV, make_map, settings, report, std::move(observer), loop);
}

/// Alg. 1 with a correspondence of the user's own.
template <denoiser Phi, canonical_maps Maps, class MakeMap>
latents<typename Phi::real_type> render(Phi const& phi, Maps const& UV, MakeMap const& make_map,
                                        render_settings<typename Phi::real_type> const& settings, render_report& report,
                                        progress_observer observer = {}, any_loop const& loop = {}) {
    require_correspondence_map<map_made_by<MakeMap>>();
    return render(generative_rendering{}, phi, UV, make_map, settings, report, std::move(observer), loop);
}

/// Alg. 1: Generative Rendering, as the paper has it.
template <denoiser Phi, canonical_maps Maps>
latents<typename Phi::real_type> render(Phi const& phi, Maps const& UV,
                                        render_settings<typename Phi::real_type> const& settings, render_report& report,
                                        progress_observer observer = {}, any_loop const& loop = {}) {
    return render(generative_rendering{}, phi, UV, settings, report, std::move(observer), loop);
}

/// What follows renders nothing: it says in a sentence which argument of render() is not what it must be.
template <class Phi, class Maps, class... Rest>
    requires(canonical_maps<Maps> && !denoiser<Phi>)
auto render(Phi const&, Maps const&, Rest const&...) { require_denoiser<Phi>(); }

template <class Method, class Phi, class Maps, class... Rest>
    requires(canonical_maps<Maps> && !denoiser<Phi>)
auto render(Method const&, Phi const&, Maps const&, Rest const&...) { require_denoiser<Phi>(); }

template <denoiser Phi, class Maps, class... Rest>
    requires(!canonical_maps<Maps>)
auto render(Phi const&, Maps const&, Rest const&...) { require_canonical_maps<Maps>(); }

template <denoiser Phi, canonical_maps Maps, class Real, class... Rest>
    requires(!std::is_same_v<Real, typename Phi::real_type>)
auto render(Phi const&, Maps const&, render_settings<Real> const&, Rest const&...) {
    static_assert(std::is_same_v<Real, typename Phi::real_type>,
                  "render: settings are render_settings<Real> with the real_type of the denoiser");
}

} // namespace genrender

#include <genrender/core/end_header.inl>
