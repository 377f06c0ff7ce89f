// SPDX-License-Identifier: MIT
// What tells runs apart, one setting, pixel and site after the other.
#include <genrender/pipeline/run_fingerprint.hpp>

#include "../support/random_scene.hpp"

#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/maps/uv_maps.hpp>
#include <genrender/pipeline/generative_rendering.hpp>
#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <vector>

using namespace genrender;

TEST_SUITE("pipeline/run_fingerprint") {
    namespace {

    using denoiser_of_8 = testing::analytic_denoiser<float>;
    using map_of_uv = chosen_correspondence<2>;

    template <class Method = generative_rendering, class Map = map_of_uv>
    std::uint64_t settings_of(render_settings<float> const& settings) {
        denoiser_of_8 const phi{.grid = {8, 8}};
        return fingerprint_of_settings<Map>(phi, settings, Method{}, 6, {32, 32});
    }

    using change = std::function<void(render_settings<float>&)>;

    } // namespace

    TEST_CASE("every setting that changes frames changes it") {
        using S = render_settings<float>;
        std::vector<change> const changes{
            [](S& s) { s.steps = 51; },
            [](S& s) { s.sigma_min = 0.03F; },
            [](S& s) { s.sigma_max = 14; },
            [](S& s) { s.rho = 6; },
            [](S& s) { s.sampler = sampler_kind::heun; },
            [](S& s) { s.sampler = sampler_kind::dpmpp_2m; },
            [](S& s) { s.noise.kind = noise_kind::fixed; },
            [](S& s) { s.noise.background = background_noise::independent; },
            [](S& s) { s.noise.T = 64; },
            [](S& s) { s.noise.seed = 1; },
            [](S& s) { s.noise.reading = noise_reading::nearest_texel; },
            [](S& s) {
                s.noise.background = background_noise::environment;
                s.noise.rays.direction = [](frame_index, double row, double) { return std::array{1.0, row, 0.0}; };
            },
            [](S& s) {
                s.noise.background = background_noise::environment;
                s.noise.rays.direction = [](frame_index i, double, double) {
                    return std::array{1.0, double{1} * i.value, 0.0};
                };
            },
            [](S& s) { s.keyframes.count = 3; },
            [](S& s) { s.keyframes.drawing = keyframe_drawing::stratified; },
            [](S& s) {
                s.keyframes.drawing = keyframe_drawing::fixed;
                s.keyframes.frames = {{1}};
            },
            [](S& s) {
                s.keyframes.drawing = keyframe_drawing::fixed;
                s.keyframes.frames = {{2}};
            },
            [](S& s) { s.keyframes.seed = 1; },
            [](S& s) { s.correspondence.kind = correspondence_kind::texel_grid; },
            [](S& s) { s.correspondence.footprint.reach = 2; },
            [](S& s) { s.correspondence.texels.T = 64; },
            [](S& s) { s.correspondence.texels.dilation = 1; },
            [](S& s) { s.consensus.enabled = false; },
            [](S& s) { s.consensus.window_begin = 0.1F; },
            [](S& s) { s.consensus.window_end = 0.8F; },
            [](S& s) { s.consensus.strength = [](std::size_t step) { return step == 49 ? 0.5F : 1.0F; }; },
            [](S& s) { s.consensus.sources.count = 2; },
            [](S& s) { s.consensus.sources.seed = 2; },
            [](S& s) { s.consensus.first_fill_share = 0.5F; },
            [](S& s) { s.consensus.average = texel_average::plain; },
            [](S& s) { s.consensus.quality.threshold = 0.5; },
            [](S& s) { s.consensus.most_gain = 1; },
            [](S& s) { s.consensus.fades_at_silhouettes = false; },
            [](S& s) { s.consensus.agrees_on_background = false; },
            [](S& s) { s.consensus.background_distance = 1; },
            [](S& s) { s.normalization.enabled = true; },
            [](S& s) { s.normalization.statistics = adain_statistics::low_band; },
            [](S& s) { s.normalization.target = adain_target::all_frames; },
            [](S& s) { s.normalization.window_begin = 0.1F; },
            [](S& s) { s.normalization.window_end = 0.9F; },
            [](S& s) { s.normalization.least_pixels = 3; },
            [](S& s) { s.normalization.fallback = without_background::all_pixels; },
            [](S& s) { s.normalization.on_noisy_latents = true; },
            [](S& s) { s.normalization.enough_background = 0.2F; },
            [](S& s) { s.normalization.standard_errors = 3; },
            [](S& s) { s.normalization.most_gain = 1.2F; },
            [](S& s) { s.normalization.band_levels = 3; },
            [](S& s) { s.layers = [](attention_site const&, std::uint32_t) { return true; }; },
            [](S& s) { s.alpha = constant_alpha(0.5F); },
            [](S& s) { s.alpha = [](std::size_t step, attention_site const&) { return step == 49 ? 0.5F : 0.7F; }; },
            [](S& s) { s.latents_grid_alpha = 1; },
            [](S& s) { s.injection.pre_attention = false; },
            [](S& s) { s.injection.post_attention = false; },
            [](S& s) { s.injection.keeps_own_copy = false; },
            [](S& s) { s.injection.length_correction = 1; },
            [](S& s) { s.injection.counts_points = true; },
            [](S& s) { s.injection.variance.target = variance_target::total; },
            [](S& s) { s.injection.variance.most_gain = 3; },
            [](S& s) { s.first_fill_share = 0.25F; },
            [](S& s) { s.average = texel_average::winner; },
            [](S& s) { s.quality.exponent_begin = 2; },
            [](S& s) { s.quality.exponent_end = 2; },
            [](S& s) { s.window_begin = 0.1F; },
            [](S& s) { s.window_end = 0.9F; },
            [](S& s) { s.keyframe_storage = feature_storage::f16; },
        };
        std::set<std::uint64_t> seen{settings_of({}), settings_of<pix2video>({}), settings_of<tokenflow>({}),
                                     settings_of<generative_rendering, chosen_correspondence<3>>({})};
        CHECK(seen.size() == 4);
        for (auto const& make : changes) {
            render_settings<float> settings;
            make(settings);
            CHECK(seen.insert(settings_of(settings)).second);
            CHECK(settings_of(settings) == settings_of(settings));
        }
    }
    TEST_CASE("what shares frames among calls and memory does not") {
        using S = render_settings<float>;
        for (change const& make :
             {change([](S& s) { s.reuses_keyframes = false; }), change([](S& s) { s.frames_per_call = 4; }),
              change([](S& s) { s.fills_last_call = true; }), change([](S& s) { s.calls_at_once = 1; }),
              change([](S& s) { s.correspondence.footprint.match_cache_bytes = 1; }),
              change([](S& s) { s.correspondence.footprint.cached_frames = 1; })}) {
            render_settings<float> settings;
            make(settings);
            CHECK(settings_of(settings) == settings_of({}));
        }
    }
    TEST_CASE("extents, coverage, object and point of every pixel change that of maps, hidden points do not") {
        auto const scene = testing::random_scene(33, 2, {8, 8}, 2);
        auto const of = [](uv_maps const& maps) { return fingerprint_of_maps(to_uv_view(maps)); };
        std::set<std::uint64_t> seen{of(scene),
                                     of(testing::random_scene(33, 3, {8, 8}, 2)),
                                     of(uv_maps(2, {8, 8})),
                                     of(uv_maps(2, {4, 16})),
                                     of(uv_maps(4, {8, 4})),
                                     of(uv_maps(1, {8, 16}))};
        std::size_t expected = 6;
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t row = 0; row < 8; ++row) {
                for (std::size_t column = 0; column < 8; ++column) {
                    auto changed = scene;
                    if (scene.coverage(i, row, column) == 0) {
                        changed.uv(i, row, column, 0) += 0.5F;
                        changed.object(i, row, column) += 1;
                        CHECK(of(changed) == of(scene));
                        changed.coverage(i, row, column) = 1;
                        seen.insert(of(changed));
                        ++expected;
                        continue;
                    }
                    changed.coverage(i, row, column) = 0;
                    seen.insert(of(changed));
                    changed = scene;
                    changed.object(i, row, column) += 1;
                    seen.insert(of(changed));
                    changed = scene;
                    changed.uv(i, row, column, 1) += 1e-6F;
                    seen.insert(of(changed));
                    expected += 3;
                }
            }
        }
        CHECK(seen.size() == expected);
    }
    TEST_CASE("latents, branches, sites and key change that of the model") {
        denoiser_of_8 const phi{.grid = {8, 8}};
        auto other_grid = phi;
        other_grid.grid = {4, 16};
        testing::analytic_denoiser<double> const other_scalar{.grid = {8, 8}};
        auto other_channels = phi;
        other_channels.channels = 4;
        auto other_branches = phi;
        other_branches.guidance_branches = 2;
        auto other_name = phi;
        other_name.site_list[2].name += "x";
        auto other_width = phi;
        other_width.site_list[2].channels += 1;
        auto fewer = phi;
        fewer.site_list.pop_back();
        std::set<std::uint64_t> const seen{fingerprint_of_model(phi, ""),
                                           fingerprint_of_model(phi, "a red ball"),
                                           fingerprint_of_model(phi, "a red ball "),
                                           fingerprint_of_model(other_grid, ""),
                                           fingerprint_of_model(other_channels, ""),
                                           fingerprint_of_model(other_branches, ""),
                                           fingerprint_of_model(other_name, ""),
                                           fingerprint_of_model(other_width, ""),
                                           fingerprint_of_model(fewer, ""),
                                           fingerprint_of_model(other_scalar, "")};
        CHECK(seen.size() == 10);
    }
}
