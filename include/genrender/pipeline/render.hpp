// SPDX-License-Identifier: MIT
// [GR alg. 1] Generative Rendering: from the UV maps of an animated scene to consistent latents, with the user's
// denoiser.
#pragma once

#include <genrender/core/begin_header.inl>

#include <genrender/blending/blend_plan.hpp>
#include <genrender/core/finite.hpp>
#include <genrender/core/instance.hpp>
#include <genrender/correspondence/chosen_correspondence.hpp>
#include <genrender/maps/background_mask.hpp>
#include <genrender/maps/cell_extents.hpp>
#include <genrender/maps/cell_shares.hpp>
#include <genrender/pipeline/checkpoint.hpp>
#include <genrender/pipeline/finished_step.hpp>
#include <genrender/pipeline/render_arguments.hpp>
#include <genrender/pipeline/run_fingerprint.hpp>
#include <genrender/pipeline/run_sampler.hpp>
#include <genrender/pipeline/sequence_denoiser.hpp>
#include <genrender/pipeline/shapes_of_run.hpp>
#include <genrender/sampling/karras_schedule.hpp>
#include <genrender/sampling/latent_lender.hpp>
#include <genrender/sampling/run_demands.hpp>
#include <genrender/sampling/run_shapes.hpp>
#include <genrender/sampling/storing_denoiser.hpp>

#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
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
    constexpr std::size_t most_filled = 65536;
    require_value(!settings.fills_last_call || settings.frames_per_call <= most_filled, "render",
                  "settings.frames_per_call", settings.frames_per_call,
                  "at most 65536 frames where the last call is filled");
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
    require_value(is_finite(settings.injection.length_correction) && settings.injection.length_correction >= 0,
                  "render", "settings.injection.length_correction", settings.injection.length_correction,
                  "a finite number, 0 or more");
    require_kept_variance("render", settings.injection.variance);
    require_value(settings.latents_grid_alpha >= 0 && settings.latents_grid_alpha <= 1, "render",
                  "settings.latents_grid_alpha", settings.latents_grid_alpha, "a share in [0, 1]");
    require_quality_settings("render", settings.quality);
    require_consensus_settings("render", settings.consensus, settings.steps);
    require_adain_settings("render", settings.normalization);
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
/// counted anew in each step that has them; of one that begins at step `first`, in what is left. Throws value_error if a
/// step's keyframes cannot be drawn.
template <class Real, class Method = generative_rendering>
std::size_t frames_to_denoise(render_settings<Real> const& settings, std::size_t frames, Method const& method = {},
                              std::size_t first = 0) {
    std::size_t total = 0;
    for (std::size_t step = first; step < settings.steps; ++step) {
        total +=
            evaluations_at(settings.sampler, step - first) * (frames + method.keyframes(settings, frames, step).size());
    }
    return total;
}

/// Says that settings of one scalar do not fit a denoiser of another; never run.
template <class Real>
template <class Other>
    requires(!std::is_same_v<Other, Real>)
render_settings<Real>::operator render_settings<Other>() const {
    static_assert(std::is_same_v<Other, Real>, "render: settings are render_settings<real_type of the denoiser>");
    return {};
}

namespace detail {

/// `Map`, or for void the map that settings choose for maps of D canonical coordinates.
template <class Map, std::size_t D>
using map_or_chosen = std::conditional_t<std::is_void_v<Map>, chosen_correspondence<D>, Map>;

/// The canonical coordinates of maps; 2 for what are none.
template <class Maps>
inline constexpr std::size_t dimensions_of = 2;
template <canonical_maps Maps>
inline constexpr std::size_t dimensions_of<Maps> = Maps::dimensions;

/// Compiles what geometry decides, once for the animation: the correspondence maps of all sites that take part, and of
/// the latents for a consensus.
template <class Map, class Phi, class Method, class Real, class MakeMap>
correspondence_set<Map> compile_maps(Phi const& phi, Method const& method, render_settings<Real> const& settings,
                                     MakeMap const& make_map) {
    correspondence_set<Map> maps;
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
    if (uses_consensus(settings)) {
        maps.add_unlisted(phi.latent_grid(), make_map);
    }
    return maps;
}

} // namespace detail

GENRENDER_INSTANCE(make_blend_plan<float, chosen_correspondence<2>>);
GENRENDER_INSTANCE(make_blend_plan<float, chosen_correspondence<3>>);
GENRENDER_INSTANCE(make_blend_plan<double, chosen_correspondence<2>>);

/// Renders an animation by a method with a denoiser: [GR alg. 1] unless another method is named. UV maps [frames,
/// height, width] are of full resolution, a whole multiple of the denoiser's latent grid and feature grids; the denoiser
/// owns prompt and depth. `Map` is named for a correspondence of the user's own. The same seeds give the same frames.
///
///     auto const result = render(phi, UV, {.settings = settings, .observer = show, .loop = threaded_loop(4)});
///     auto const flow = render<tokenflow>(phi, UV, {.settings = settings});
///     auto const own = render<generative_rendering, my_map>(phi, UV, {.settings = settings, .make_map = make_my_map});
///
/// A preparable_denoiser is told the shapes of the run before its first call. Noise is made in host memory; latents of a
/// latent_lender are its engine's from there to the end. Throws value_error or shape_error for
/// arguments that do not fit, a checkpoint of another run among them, before anything is run, and what the denoiser or
/// after_step throws. A run that its observer ends returns what there is.
template <class Method = generative_rendering, class Map = void, class Phi, class Maps>
render_result<typename detail::real_type_of<Phi>::type>
render(Phi const& phi, Maps const& UV,
       render_arguments<typename detail::real_type_of<Phi>::type, Method,
                        detail::map_or_chosen<Map, detail::dimensions_of<Maps>>> const& arguments) {
    // As require_denoiser, require_latent_lender and require_canonical_maps, and here so that a compiler comes to the
    // sentence at once.
    static_assert(detail::denoiser_names_types<Phi>, GENRENDER_DENOISER_TYPES);
    static_assert(detail::denoiser_tells_latents<Phi>, GENRENDER_DENOISER_LATENTS);
    static_assert(detail::denoiser_tells_sites<Phi>, GENRENDER_DENOISER_SITES);
    static_assert(detail::denoiser_tells_branches<Phi>, GENRENDER_DENOISER_BRANCHES);
    static_assert(detail::denoiser_call_is_const<Phi>, GENRENDER_DENOISER_CONST);
    static_assert(detail::denoiser_keeps_z<Phi>, GENRENDER_DENOISER_Z);
    static_assert(detail::denoiser_call_is_right<Phi> || !detail::denoiser_call_is_const<Phi> ||
                      !detail::denoiser_keeps_z<Phi>,
                  GENRENDER_DENOISER_CALL);
    static_assert(detail::lender_names_handle<Phi>, GENRENDER_LENDER_HANDLE);
    static_assert(detail::lender_uploads<Phi>, GENRENDER_LENDER_UPLOAD);
    static_assert(detail::lender_downloads<Phi>, GENRENDER_LENDER_DOWNLOAD);
    static_assert(detail::lender_gives_frames<Phi>, GENRENDER_LENDER_FRAMES);
    static_assert(detail::lender_joins<Phi>, GENRENDER_LENDER_JOINED);
    static_assert(detail::lender_combines<Phi>, GENRENDER_LENDER_COMBINATION);
    static_assert(detail::lender_tells_finite<Phi>, GENRENDER_LENDER_FINITE);
    static_assert(detail::lender_estimates<Phi>, GENRENDER_LENDER_CALL);
    static_assert(detail::lender_stops<Phi>, GENRENDER_LENDER_STOPS);
    static_assert(detail::maps_tell_dimensions<Maps>, GENRENDER_MAPS_DIMENSIONS);
    static_assert(detail::maps_tell_extents<Maps>, GENRENDER_MAPS_EXTENTS);
    static_assert(detail::maps_tell_coverage<Maps>, GENRENDER_MAPS_COVERAGE);
    static_assert(detail::maps_tell_objects<Maps>, GENRENDER_MAPS_OBJECTS);
    static_assert(detail::maps_tell_points<Maps>, GENRENDER_MAPS_POINTS);
    if constexpr (denoiser<Phi> && canonical_maps<Maps>) {
        using Real = typename Phi::real_type;
        using map_type = detail::map_or_chosen<Map, Maps::dimensions>;
        static_assert(sequence_method<Method, sequence_passes<Phi, map_type>>, "render: Method is a sequence_method");
        auto const& settings = arguments.settings;
        auto const& method = arguments.method;
        auto const& loop = arguments.loop;
        require_render_settings(settings, UV.frame_count());
        require_finite_coordinates(UV);
        auto const grid = grid_extents(phi.latent_grid());
        cell_extents("render", UV.grid(), grid);
        auto const sigmas = karras_schedule<Real>(settings.steps, settings.sigma_min, settings.sigma_max, settings.rho);
        auto const N = UV.frame_count();
        auto const total =
            frames_to_denoise(settings, N, method, arguments.resume != nullptr ? arguments.resume->steps : 0);

        auto const start = std::chrono::steady_clock::now();
        render_result<Real> result{latents<Real>::from_shape({N, phi.latent_channels(), grid.height, grid.width}), {}};
        result.report.kernels = chosen_vector_target();
        report_writer report(result.report);
        std::optional<run_fingerprint> of_run; // of whoever asks
        auto const fingerprint = [&]() -> run_fingerprint const& {
            return of_run ? *of_run
                          : of_run.emplace(fingerprint_of<map_type>(phi, UV, settings, method, arguments.model_key));
        };

        // z_UV ~ N(0, I); z = z_T = sigma_T pi_UV(z_UV)
        if (arguments.resume == nullptr) {
            std::vector<frame_index> frames;
            for (std::uint32_t i = 0; i < N; ++i) {
                frames.push_back({i});
            }
            initial_noise(to_view(result.z), UV, frames, settings.noise, loop);
            result.z *= sigmas.front();
        } else {
            require_resumable(*arguments.resume, fingerprint(),
                              {N, std::size_t{phi.latent_channels()}, grid.height, grid.width}, settings.steps,
                              remembers_estimates(settings.sampler));
            result.z = arguments.resume->z;
            result.report = arguments.resume->report;
        }

        auto const background = background_mask(UV, grid);
        auto const shares = uses_consensus(settings) && settings.consensus.fades_at_silhouettes
                                ? cell_shares(UV, grid)
                                : tensor<std::uint8_t, 3>();
        auto const maps = detail::compile_maps<map_type>(phi, method, settings, [&](grid_extents extents) {
            if constexpr (std::is_void_v<Map>) {
                if (!arguments.make_map) {
                    return map_type(UV, extents, settings.correspondence, loop);
                }
            } else {
                require_value(arguments.make_map != nullptr, "render", "make_map", "empty",
                              "a function that compiles the named map");
            }
            return arguments.make_map(extents);
        });
        report.add_seconds(0, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        auto const shapes = shapes_of_run(phi, settings, N, maps, method);
        require_storage<Phi>(shapes.storage);
        require_demands<Phi>(shapes);
        prepare_denoiser(phi, shapes);

        // for t = T, ..., 1: what the method does, for alg. 1 keyframes, features, blending and injection; normalisation
        progress_meter meter(settings.steps, total, arguments.observer);
        sequence_denoiser const D(phi, maps, to_view(background), std::span<Real const>(sigmas), settings, loop, meter,
                                  report, method, to_view(shares));
        step_observer<Real> told;
        if (arguments.after_step) {
            told = [&](std::size_t step, auto const& z, auto const& x0) {
                arguments.after_step({step, settings.steps, z, x0, [&] {
                                          checkpoint<Real> here{step + 1, z(), {}, fingerprint(), result.report};
                                          if (remembers_estimates(settings.sampler)) {
                                              here.x0_last = x0();
                                          }
                                          return here;
                                      }});
            };
        }
        result.is_cancelled = run_sampler<Real>(phi, D, result.z, sigmas, settings.sampler, told, arguments.resume);
        return result;
    }
}

} // namespace genrender

#include <genrender/core/end_header.inl>
