// SPDX-License-Identifier: MIT
// [GR alg. 1] Whole runs.
#include <genrender/pipeline/render.hpp>

#include <genrender/testing/analytic_denoiser.hpp>
#include "../support/random_scene.hpp"

#include <genrender/baselines/baseline_settings.hpp>
#include <genrender/baselines/per_frame.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/evaluation/correspondence_error.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

using namespace genrender;

TEST_SUITE("pipeline/render") {
    namespace {

    testing::analytic_denoiser<double> with_attention() { return {.grid = {8, 8}, .attention = 0.5}; }

    uv_maps const& scene() {
        static auto const maps = testing::random_scene(33, 6, {32, 32}, 3);
        return maps;
    }

    render_settings<double> few_steps() {
        render_settings<double> settings = render_settings<double>::plain();
        settings.steps = 4;
        settings.keyframes.count = 3;
        return settings;
    }

    template <class Phi>
    latents<double> run(Phi const& phi, render_settings<double> const& settings, std::size_t threads = 1) {
        return render(phi, to_uv_view(scene()), {.settings = settings, .loop = threaded_loop(threads)}).z;
    }

    double difference(latents<double> const& a, latents<double> const& b) {
        double worst = 0;
        for (std::size_t e = 0; e < a.size(); ++e) {
            worst = std::max(worst, std::abs(a.data()[e] - b.data()[e]));
        }
        return worst;
    }

    } // namespace

    TEST_CASE_TEMPLATE("[GR alg. 1] with a denoiser of known answer every sampler reaches it", Real, float, double) {
        testing::analytic_denoiser<Real> const phi{.grid = {8, 8}}; // no attention: the exact posterior
        render_settings<Real> settings = render_settings<Real>::plain();
        settings.normalization.enabled = false;
        settings.keyframes.count = 2;
        settings.steps = 60;
        auto z_T = latents<Real>::from_shape({6, 3, 8, 8});
        std::vector<frame_index> const frames{{0}, {1}, {2}, {3}, {4}, {5}};
        initial_noise(to_view(z_T), to_uv_view(scene()), frames, settings.noise);
        z_T *= settings.sigma_max;
        auto const shrink = phi.spread / std::sqrt(phi.spread * phi.spread + settings.sigma_max * settings.sigma_max);
        for (auto const& [method, bound] : {std::pair(sampler_kind::euler, 0.05), std::pair(sampler_kind::heun, 0.005),
                                            std::pair(sampler_kind::dpmpp_2m, 0.005)}) {
            settings.sampler = method;
            auto const z = render(phi, to_uv_view(scene()), {.settings = settings}).z;
            double worst = 0;
            for (std::size_t e = 0; e < z.size(); ++e) {
                auto const exact = phi.mean + (z_T.data()[e] - phi.mean) * shrink;
                worst = std::max(worst, std::abs(static_cast<double>(z.data()[e] - exact)));
            }
            CHECK(worst < bound);
        }
    }
    TEST_CASE("the same seed gives the same frames on one and two threads and for any number of frames a call") {
        auto const phi = with_attention();
        auto settings = few_steps();
        auto const one = run(phi, settings, 1);
        CHECK(difference(one, run(phi, settings, 2)) == 0);
        settings.frames_per_call = 4;
        CHECK(difference(one, run(phi, settings, 2)) == 0);
        settings.frames_per_call = std::numeric_limits<std::size_t>::max();
        CHECK(difference(one, run(phi, settings, 2)) == 0);
        settings.keyframes.seed = 1;
        CHECK(difference(one, run(phi, settings)) > 0);
        settings.keyframes.seed = 0;
        settings.noise.seed = 1;
        CHECK(difference(one, run(phi, settings)) > 1e-3);
    }
    TEST_CASE("with the consensus of vivid frames are the same on any number of threads, and others than without") {
        auto const phi = with_attention();
        auto settings = few_steps();
        auto const without = run(phi, settings, 1);
        settings.consensus.enabled = true;
        auto const one = run(phi, settings, 1);
        CHECK(difference(one, run(phi, settings, 2)) == 0);
        CHECK(difference(one, run(phi, settings, 5)) == 0);
        CHECK(difference(one, without) > 1e-3);
        settings.consensus.agrees_on_background = false;
        CHECK(difference(one, run(phi, settings)) > 0);
    }
    TEST_CASE("[GR eq. 6] no alpha at the latents' grid is no post-attention there") {
        auto const phi = with_attention();
        auto settings = few_steps();
        auto const everywhere = run(phi, settings);
        settings.latents_grid_alpha = 0;
        auto const coarse = run(phi, settings);
        settings.latents_grid_alpha = 1;
        settings.alpha = [grid = phi.latent_grid()](std::size_t, attention_site const& site) {
            return site.grid == grid ? 0.0 : paper_alpha;
        };
        CHECK(difference(coarse, run(phi, settings)) == 0);
        CHECK(difference(coarse, everywhere) > 0);
    }
    TEST_CASE("each switch changes what it should and nothing else") {
        auto const phi = with_attention();
        auto settings = few_steps();
        auto const full = run(phi, settings);
        auto const changed = [&](auto&& change) {
            auto other = few_steps();
            change(other);
            return run(phi, other);
        };
        auto const no_post = changed([](auto& s) { s.injection.post_attention = false; });
        CHECK(difference(full, no_post) > 1e-4);
        CHECK(difference(no_post, changed([](auto& s) {
                             s.alpha = [](std::size_t, attention_site const&) { return 0.0; };
                         })) == 0);
        auto const no_pre = changed([](auto& s) { s.injection.pre_attention = false; });
        CHECK(difference(full, no_pre) > 1e-4);
        auto const neither = changed([](auto& s) { s.injection.pre_attention = s.injection.post_attention = false; });
        CHECK(difference(neither, changed([](auto& s) { s.window_end = 0; })) == 0);
        CHECK(difference(full, changed([](auto& s) { s.window_end = 0.5; })) > 1e-6);
        CHECK(difference(full, changed([](auto& s) { s.normalization.enabled = false; })) > 1e-6);
        CHECK(difference(full, changed([](auto& s) { s.normalization.window_begin = s.normalization.window_end; })) ==
              doctest::Approx(difference(full, changed([](auto& s) { s.normalization.enabled = false; }))));
        CHECK(difference(full, changed([](auto& s) { s.normalization.on_noisy_latents = true; })) > 1e-6);
        CHECK(difference(full, changed([](auto& s) { s.injection.keeps_own_copy = false; })) > 1e-9);
        CHECK(difference(full, changed([](auto& s) { s.first_fill_share = 1; })) > 1e-9);
        auto const by_texels = [](auto& s) { s.correspondence.kind = correspondence_kind::texel_grid; };
        CHECK(difference(full, changed(by_texels)) > 1e-9);
        CHECK(difference(changed(by_texels), changed([&](auto& s) {
                             by_texels(s);
                             s.correspondence.texels.T = 2;
                         })) > 1e-6);
        CHECK(difference(full, changed([](auto& s) { s.correspondence.footprint.reach = 0.1; })) > 1e-6);
        CHECK(difference(full, changed([](auto& s) { s.average = texel_average::plain; })) > 1e-9);
        auto const by_nearest = [](auto& s) { s.noise.reading = noise_reading::nearest_texel; };
        CHECK(difference(full, changed(by_nearest)) > 1e-3);
        CHECK(difference(changed(by_nearest), changed([&](auto& s) {
                             by_nearest(s);
                             s.noise.T = 2;
                         })) > 1e-3);
        CHECK(difference(full, changed([](auto& s) { s.keyframes.drawing = keyframe_drawing::stratified; })) > 1e-9);
        CHECK(difference(full, changed([](auto& s) { s.keyframes.drawing = keyframe_drawing::held; })) > 1e-9);
        CHECK(difference(full, changed([](auto& s) { s.injection.length_correction = 1; })) > 1e-9);
        CHECK(difference(full, changed([](auto& s) { s.injection.variance.target = variance_target::total; })) > 1e-9);
        auto const counted = changed([](auto& s) { s.injection.counts_points = true; });
        CHECK(difference(full, counted) > 1e-9);
        CHECK(difference(no_post, changed([](auto& s) { // makes plans all the same
                             s.injection.post_attention = false;
                             s.injection.counts_points = true;
                         })) > 1e-9);
        CHECK(difference(full, changed([](auto& s) { s.average = texel_average::winner; })) > 1e-9);
        CHECK(difference(full, changed([](auto& s) { s.quality.exponent_end = 6; })) > 1e-9);
        CHECK(difference(full, changed([](auto& s) { s.quality.exponent_begin = 0; })) > 1e-9);
        CHECK(difference(full, changed([](auto& s) { s.quality.threshold = 1; })) > 1e-9);
    }
    TEST_CASE("[GR sec. 4: Ablation studies] each ablation is one setting away from the full method") {
        auto const phi = with_attention();
        auto const full = run(phi, few_steps());
        using settings_type = render_settings<double>;
        std::vector<std::pair<char const*, void (*)(settings_type&)>> const ablations{
            {"no pre-attention", [](settings_type& s) { s.injection.pre_attention = false; }},
            {"no post-attention", [](settings_type& s) { s.injection.post_attention = false; }},
            {"fixed noise", [](settings_type& s) { s.noise.kind = noise_kind::fixed; }},
            {"independent noise", [](settings_type& s) { s.noise.kind = noise_kind::independent; }},
            {"no latent normalisation", [](settings_type& s) { s.normalization.enabled = false; }}};
        std::vector<latents<double>> results{full};
        for (auto const& ablation : ablations) {
            CAPTURE(ablation.first);
            auto settings = few_steps();
            ablation.second(settings);
            results.push_back(run(phi, settings));
            for (std::size_t other = 0; other + 1 < results.size(); ++other) {
                CHECK(difference(results.back(), results[other]) > 1e-6);
            }
        }
    }
    TEST_CASE("a consensus changes what its settings say and nothing where they say nothing") {
        auto const phi = with_attention();
        auto const with = [&](auto&& change, std::size_t threads = 1) {
            auto settings = few_steps();
            settings.consensus.enabled = true;
            change(settings.consensus);
            return run(phi, settings, threads);
        };
        auto const none = run(phi, few_steps());
        auto const full = with([](auto&) {});
        CHECK(difference(full, none) > 1e-3);
        CHECK(difference(full, with([](auto&) {}, 2)) == 0);
        CHECK(difference(full, with([](auto&) {}, 5)) == 0);
        auto const on_surfaces = [&](auto&& change) {
            return with([&](auto& c) {
                c.agrees_on_background = false;
                change(c);
            });
        };
        CHECK(difference(none, on_surfaces([](auto& c) { c.window_end = 0; })) == 0);
        CHECK(difference(none, on_surfaces([](auto& c) { c.strength = [](std::size_t) { return 0.0; }; })) == 0);
        CHECK(difference(none, with([](auto& c) { c.window_end = 0; })) > 0); // the background
        CHECK(difference(full, with([](auto& c) { c.background_distance = 9; })) > 0);
        CHECK(difference(full, with([](auto& c) { c.window_end = 1; })) > 1e-6);
        CHECK(difference(full, with([](auto& c) { c.window_begin = 0.25; })) > 1e-6);
        CHECK(difference(full, with([](auto& c) { c.strength = [](std::size_t) { return 0.5; }; })) > 1e-6);
        CHECK(difference(full, with([](auto& c) { c.sources.count = 2; })) > 1e-6);
        CHECK(difference(full, with([](auto& c) { c.first_fill_share = 1; })) > 1e-6);
        CHECK(difference(full, with([](auto& c) { c.average = texel_average::plain; })) > 1e-9);
        CHECK(difference(full, with([](auto& c) { c.most_gain = 1; })) > 1e-6);
        CHECK(difference(full, with([](auto& c) { c.fades_at_silhouettes = false; })) > 1e-6);
        auto const of_seed = [&](std::uint64_t seed) {
            return with([&](auto& c) {
                c.sources.count = 2;
                c.sources.seed = seed;
            });
        };
        CHECK(difference(of_seed(0), of_seed(1)) > 1e-6);
    }
    TEST_CASE(
        "a consensus makes corresponding pixels of every method agree better and needs no site of the latents' grid") {
        auto const maps = testing::random_scene(40, 12, {64, 64}, 3);
        testing::analytic_denoiser<double> const phi{.grid = {16, 16}, .attention = 0.3};
        texel_grid const pixels(to_uv_view(maps), {16, 16});
        auto const compare = [&](std::string const& name, auto const& render_with) {
            auto settings = few_steps();
            settings.noise.kind = noise_kind::independent;
            auto const without = render_with(settings, false);
            auto const with = render_with(settings, true);
            auto const before = *correspondence_error(to_view(without.z), pixels, 5);
            auto const after = *correspondence_error(to_view(with.z), pixels, 5);
            MESSAGE(name, ": error ", before, " without and ", after, " with a consensus, which covers ",
                    with.report.consensus.share());
            CHECK(after < 0.8 * before);
            CHECK(without.report.consensus.on_objects == 0);
            CHECK(with.report.consensus.share() > 0.99); // every frame is a source here
            CHECK(with.report.consensus_seconds > 0);
        };
        compare("per frame", [&](auto settings, bool has_consensus) {
            settings = per_frame(settings); // compiles no map of its own
            settings.consensus.enabled = has_consensus;
            return render(phi, to_uv_view(maps), {.settings = settings});
        });
        compare("tokenflow", [&](auto settings, bool has_consensus) {
            settings = baseline_settings(settings, noise_kind::independent);
            settings.consensus.enabled = has_consensus;
            return render<tokenflow>(phi, to_uv_view(maps), {.settings = settings});
        });
        compare("generative rendering", [&](auto settings, bool has_consensus) {
            settings.consensus.enabled = has_consensus;
            return render(phi, to_uv_view(maps), {.settings = settings});
        });
    }
    TEST_CASE("settings of consensus and normalisation that say nothing are refused before anything runs") {
        auto settings = few_steps();
        settings.consensus.most_gain = 0;
        CHECK_THROWS_WITH_AS(run(with_attention(), settings),
                             "render: settings.consensus.most_gain is 0.000000, expected a factor of at least 1",
                             value_error);
        settings = few_steps();
        settings.normalization.band_levels = 0;
        CHECK_THROWS_WITH_AS(run(with_attention(), settings), "render: settings.band_levels is 0, expected 1 to 12",
                             value_error);
    }
    TEST_CASE("the default method may be named") {
        auto const phi = with_attention();
        auto const z = render<generative_rendering>(phi, to_uv_view(scene()), {.settings = few_steps()}).z;
        CHECK(difference(z, run(phi, few_steps())) == 0);
        auto const make_map = [](grid_extents grid) { return footprint_map(to_uv_view(scene()), grid); };
        CHECK(difference(z, render(phi, to_uv_view(scene()), {.settings = few_steps(), .method = {}}).z) == 0);
        using map_type = footprint_map<2>;
        auto const own = render<generative_rendering, map_type>(phi, to_uv_view(scene()),
                                                                {.settings = few_steps(), .make_map = make_map});
        CHECK(difference(z, own.z) == 0);
    }
    TEST_CASE("a map that is named wants a function that makes it") {
        auto const run_without = [] {
            render<generative_rendering, footprint_map<2>>(with_attention(), to_uv_view(scene()),
                                                           {.settings = few_steps()});
        };
        CHECK_THROWS_WITH_AS(run_without(),
                             "render: make_map is empty, expected a function that compiles the named map", value_error);
    }
    TEST_CASE(
        "UV noise alone makes corresponding pixels of the analytic denoiser agree better than independent noise") {
        auto const maps = testing::random_scene(40, 12, {64, 64}, 3);
        testing::analytic_denoiser<double> const phi{.grid = {16, 16}};
        texel_grid const pixels(to_uv_view(maps), {16, 16});
        auto const error = [&](noise_kind kind) {
            auto settings = few_steps();
            settings.noise.kind = kind;
            auto const z = render(phi, to_uv_view(maps), {.settings = settings}).z;
            return *correspondence_error(to_view(z), pixels, 5);
        };
        auto const uv = error(noise_kind::uv);
        auto const independent = error(noise_kind::independent);
        MESSAGE("correspondence error at interval 5: uv ", uv, ", independent ", independent);
        CHECK(uv < 0.9 * independent);
    }
    TEST_CASE("the observer sees every frame and its estimate runs out") {
        auto const phi = with_attention();
        auto const settings = few_steps();
        std::size_t calls = 0;
        std::size_t keyframe_passes = 0;
        progress last;
        auto const observe = [&](progress const& state) {
            ++calls;
            keyframe_passes += state.pass == render_pass::keyframes ? 1U : 0U;
            CHECK(state.steps == 4);
            CHECK(state.frames_done <= state.frames);
            CHECK(state.elapsed_seconds >= last.elapsed_seconds);
            last = state;
            return true;
        };
        auto const [z, report, is_cancelled] =
            render(phi, to_uv_view(scene()), {.settings = settings, .observer = observe});
        CHECK(difference(z, run(phi, settings)) == 0);
        CHECK_FALSE(is_cancelled);
        CHECK(calls == 4 * (1 + 6));
        CHECK(keyframe_passes == 4);
        CHECK(last.step == 3);
        CHECK(last.frames_done == 6);
        CHECK(last.remaining_seconds == 0);
        CHECK(report.denoiser_seconds > 0);
        CHECK(report.library_seconds > 0);
    }
    TEST_CASE("the estimate runs out for every sampler and window") {
        auto const phi = with_attention();
        for (auto const method : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            for (auto const end : {0.0, 0.6, 1.0}) {
                auto settings = few_steps();
                settings.sampler = method;
                settings.window_end = end;
                progress last;
                auto const observe = [&](progress const& state) {
                    CHECK(state.remaining_seconds >= 0);
                    last = state;
                    return true;
                };
                render(phi, to_uv_view(scene()), {.settings = settings, .observer = observe});
                CHECK(last.remaining_seconds == 0);
                CHECK(last.frames_done == 6);
            }
        }
    }
    TEST_CASE("frames to denoise are counted by hand") {
        auto settings = few_steps(); // 4 steps, 3 keyframes
        CHECK(frames_to_denoise(settings, 6) == 4 * (6 + 3));
        settings.sampler = sampler_kind::heun;
        CHECK(frames_to_denoise(settings, 6) == 7 * (6 + 3));
        settings.window_begin = 0.5; // Steps 2 and 3 have keyframes, each evaluated twice.
        CHECK(frames_to_denoise(settings, 6) == 7 * 6 + 4 * 3);
    }
    TEST_CASE("a run that its observer ends gives its report and the latents of its last whole step") {
        auto const phi = with_attention();
        auto settings = few_steps();
        settings.normalization.enabled = false;
        std::size_t calls = 0;
        std::size_t most = 1;
        auto const end_early = [&](progress const&) { return ++calls < most; };
        auto const noise = render(phi, to_uv_view(scene()), {.settings = settings, .observer = end_early});
        CHECK(noise.is_cancelled);
        CHECK(calls == 1);
        calls = 0;
        most = 9; // A step has 1 + 6 calls.
        auto const first =
            render(phi, to_uv_view(scene()), {.settings = settings, .observer = end_early, .loop = threaded_loop(2)});
        CHECK(first.is_cancelled);
        CHECK(calls == 9);
        CHECK(first.report.coverage.at({8, 8}).covered > 0);
        CHECK(first.report.denoiser_seconds > 0);

        // The noise, and the step after it by hand.
        auto z = latents<double>::from_shape({6, 3, 8, 8});
        std::vector<frame_index> const frames{{0}, {1}, {2}, {3}, {4}, {5}};
        initial_noise(to_view(z), to_uv_view(scene()), frames, settings.noise);
        z *= settings.sigma_max;
        CHECK(difference(noise.z, z) == 0);
        auto const sigmas =
            karras_schedule<double>(settings.steps, settings.sigma_min, settings.sigma_max, settings.rho);
        correspondence_set<chosen_correspondence<2>> maps;
        maps.add({8, 8}, [](grid_extents grid) {
            return chosen_correspondence<2>(to_uv_view(scene()), grid, correspondence_settings{});
        });
        auto const background = background_mask(to_uv_view(scene()), {8, 8});
        progress_meter meter(4, 100, {});
        render_report report;
        report_writer writer(report);
        sequence_denoiser const D(phi, maps, to_view(background), std::span<double const>(sigmas), settings, {}, meter,
                                  writer);
        CHECK(difference(first.z, euler_step(z, D(z, sigmas[0]), sigmas[0], sigmas[1])) < 1e-12);
    }
    TEST_CASE("cancelled before a step of any sampler ends the latents are those of the step before") {
        auto const phi = with_attention();
        for (auto const sampler : {sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            auto settings = few_steps();
            settings.sampler = sampler;
            std::size_t steps_seen = 0;
            auto const whole = run(phi, settings);
            auto const late =
                render(phi, to_uv_view(scene()), {.settings = settings, .observer = [&](progress const& now) {
                                                      steps_seen = now.step;
                                                      return now.step < 3;
                                                  }});
            CHECK(late.is_cancelled);
            CHECK(steps_seen == 3);
            CHECK(difference(late.z, whole) > 1e-9);
        }
    }
    TEST_CASE("geometry that fills the frame skips latent normalisation and says so") {
        uv_maps maps(2, {16, 16});
        maps.coverage.fill(1);
        for (std::size_t e = 0; e < maps.uv.size(); ++e) {
            maps.uv.data()[e] = static_cast<float>(e % 512) / 512;
        }
        testing::analytic_denoiser<double> const phi{.grid = {8, 8}};
        auto settings = few_steps();
        settings.keyframes.count = 1;
        auto const [z, report, is_cancelled] = render(phi, to_uv_view(maps), {.settings = settings});
        CHECK(report.skipped_frames == std::set<std::size_t>{0, 1});
        CHECK(std::isfinite(z(1, 0, 0, 0)));
    }
    TEST_CASE("a scene that shows nothing has no coverage and still renders") {
        uv_maps const maps(3, {16, 16});
        testing::analytic_denoiser<double> const phi{.grid = {8, 8}, .attention = 0.5};
        auto const [z, report, is_cancelled] = render(phi, to_uv_view(maps), {.settings = few_steps()});
        CHECK(report.coverage.at({8, 8}).on_objects == 0);
        CHECK(report.coverage.at({8, 8}).share() == 0);
        CHECK(std::isfinite(z(2, 2, 7, 7)));
    }
    TEST_CASE("arguments that no run could honour are refused by name before anything runs") {
        auto const phi = with_attention();
        auto const refuses = [&](auto&& change, char const* text) {
            auto settings = few_steps();
            change(settings);
            CHECK_THROWS_WITH_AS(render(phi, to_uv_view(scene()), {.settings = settings}), text, value_error);
        };
        refuses([](auto& s) { s.keyframes.count = 7; },
                "draw_keyframes: count is 7, expected 1 to the animation's 6 frames");
        refuses([](auto& s) { s.keyframes.count = 0; },
                "draw_keyframes: count is 0, expected 1 to the animation's 6 frames");
        refuses([](auto& s) { s.steps = 0; }, "render: settings.steps is 0, expected at least one step");
        refuses([](auto& s) { s.frames_per_call = 0; },
                "render: settings.frames_per_call is 0, expected at least one frame");
        refuses([](auto& s) { s.window_begin = 2; },
                "render: window of settings is [2.000000, 1.000000), expected 0 <= begin <= end <= 1");
        refuses([](auto& s) { s.normalization.window_end = 7; },
                "render: window of settings.normalization is [0.000000, 7.000000), expected 0 <= begin <= end <= 1");
        refuses([](auto& s) { s.first_fill_share = -1; },
                "render: settings.first_fill_share is -1.000000, expected a share in [0, 1]");
        refuses([](auto& s) { s.injection.length_correction = -1; },
                "render: settings.injection.length_correction is -1.000000, expected a finite number, 0 or more");
        refuses([](auto& s) { s.injection.variance.most_gain = 0; },
                "render: most_gain is 0.000000, expected a finite number, 1 or more");
        refuses([](auto& s) { s.quality.exponent_end = std::nan(""); },
                "render: quality.exponent_end is nan, expected a finite number, 0 or more");
        refuses([](auto& s) { s.quality.threshold = -1; },
                "render: quality.threshold is -1.000000, expected a finite number, 0 or more");
        refuses([](auto& s) { s.layers = nullptr; }, "render: settings.layers is empty, expected a function");
        refuses([](auto& s) { s.alpha = nullptr; }, "render: settings.alpha is empty, expected a function");
        refuses([](auto& s) { s.latents_grid_alpha = 1.5; },
                "render: settings.latents_grid_alpha is 1.500000, expected a share in [0, 1]");
        refuses([](auto& s) { s.alpha = [](std::size_t, attention_site const&) { return std::nan(""); }; },
                "render: settings.alpha is nan, expected finite numbers");
        auto broken = scene();
        broken.coverage(0, 16, 16) = 1;
        broken.uv(0, 16, 16, 1) = std::numeric_limits<float>::infinity();
        CHECK_THROWS_WITH_AS(render(phi, to_uv_view(broken), {.settings = few_steps()}),
                             "render: UV of frame 0 at row 16 column 16 is inf, expected finite texture coordinates",
                             value_error);
        uv_maps const none(0, {32, 32});
        CHECK_THROWS_WITH_AS(render(phi, to_uv_view(none), {.settings = few_steps()}),
                             "render: UV.frame_count() is 0, expected at least one frame", value_error);
        uv_maps const odd(3, {30, 32});
        CHECK_THROWS_WITH_AS(render(phi, to_uv_view(odd), {.settings = few_steps()}),
                             "render: grid is [8, 8], expected extents that divide the maps' [30, 32]", value_error);
    }
}
