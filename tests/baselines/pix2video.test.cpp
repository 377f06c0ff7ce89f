// SPDX-License-Identifier: MIT
// [GR sec. 4: Pix2Video*] The baseline against a plain second writing of it, and whole runs.
#include <genrender/baselines/pix2video.hpp>

#include <genrender/testing/analytic_denoiser.hpp>
#include <genrender/testing/sequence_method_laws.hpp>
#include "small_baseline_run.hpp"

#include <genrender/baselines/baseline_settings.hpp>
#include <genrender/baselines/per_frame.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <vector>

using namespace genrender;
using namespace genrender::testing;

TEST_SUITE("baselines/pix2video") {
    namespace {

    /// All frames in lockstep, each attending to frames 0 and i - 1 really joined.
    template <class Real>
    stack<Real, 4> plain_pix2video(layered_denoiser<Real> const& phi, strided_view<Real const, 4> z, Real sigma) {
        return plain_evaluation<Real>(
            phi, z, sigma, [&](attention_place place, host_features<Real> const& f, std::size_t i) {
                return dense_self_attention(phi.weights[place.site.value], joined_rows(f, {i}),
                                            joined_rows(f, {0, i > 0 ? i - 1 : 0}));
            });
    }

    /// A denoiser that forgets its processor.
    struct deaf : analytic_denoiser<double> {
        template <class Processor>
        void operator()(strided_view<double, 4> x0, strided_view<double const, 4> z, double,
                        std::span<frame_index const>, Processor&) const {
            copy(x0, in_view<double, 4>(z));
        }
    };

    } // namespace

    TEST_CASE_TEMPLATE("[GR sec. 4: Pix2Video*] an evaluation equals the plainly written method", Real, float, double) {
        for (auto const frames : {1, 2, 3, 6}) {
            small_baseline_run<Real> run(static_cast<std::size_t>(frames));
            auto const z = run.noise();
            for (auto const frames_per_call : {1, 2, 4}) {
                run.settings.frames_per_call = static_cast<std::size_t>(frames_per_call);
                auto const x0 = run.estimate(pix2video{}, z, 3);
                auto const expected = plain_pix2video<Real>(run.phi, to_view(z), 3);
                for (std::size_t i = 0; i < run.frames; ++i) {
                    CHECK(frame_difference<Real>(x0, expected.view(), i) < layered_tolerance<Real>);
                }
            }
        }
    }
    TEST_CASE("with the temperature it equals the plainly written method whose queries are sharper") {
        small_baseline_run<double> run;
        auto const z = run.noise();
        run.settings.injection.length_correction = 1;
        auto const x0 = run.estimate(pix2video{}, z, 3);
        // Sharper where two frames are joined: frames 0 and 1 attend to one.
        std::deque<matrix_module<double>> sharper;
        for (std::size_t site = 0; site < run.phi.modules.size(); ++site) {
            auto const own = run.phi.modules[site].grid.size();
            auto& module = sharper.emplace_back(run.phi.channels, 2, 100 + 10 * site);
            for (std::size_t e = 0; e < module.W_Q.size(); ++e) {
                module.W_Q.data()[e] *= std::log(2.0 * static_cast<double>(own)) / std::log(static_cast<double>(own));
            }
        }
        auto const expected = plain_evaluation<double>(
            run.phi, to_view(z), 3, [&](attention_place place, host_features<double> const& f, std::size_t i) {
                auto const& weights = i > 1 ? sharper[place.site.value] : run.phi.weights[place.site.value];
                return dense_self_attention(weights, joined_rows(f, {i}), joined_rows(f, {0, i > 0 ? i - 1 : 0}));
            });
        for (std::size_t i = 0; i < run.frames; ++i) {
            CHECK(frame_difference<double>(x0, expected.view(), i) < layered_tolerance<double>);
        }
        CHECK(frame_difference<double>(x0, plain_pix2video<double>(run.phi, to_view(z), 3).view(), 2) > 1e-3);
    }
    TEST_CASE("the first frame is denoised by itself and all others are not") {
        small_baseline_run<double> run;
        auto const z = run.noise();
        auto const x0 = run.estimate(pix2video{}, z, 3);
        run.settings.window_end = 0;
        auto const alone = run.estimate(generative_rendering{}, z, 3);
        CHECK(frame_difference<double>(x0, to_view(alone), 0) == 0);
        for (std::size_t i = 1; i < run.frames; ++i) {
            CHECK(frame_difference<double>(x0, to_view(alone), i) > 1e-3);
        }
    }
    TEST_CASE("what a frame shows reaches those after it from frame to frame and none before it") {
        small_baseline_run<double> run;
        auto z = run.noise();
        auto const x0 = run.estimate(pix2video{}, z, 3);
        for (std::size_t c = 0; c < 3; ++c) {
            z(2, c, 4, 4) += 1;
        }
        auto const changed = run.estimate(pix2video{}, z, 3);
        CHECK(frame_difference<double>(x0, to_view(changed), 0) == 0);
        CHECK(frame_difference<double>(x0, to_view(changed), 1) == 0);
        CHECK(frame_difference<double>(x0, to_view(changed), 2) > 1e-3);
        CHECK(frame_difference<double>(x0, to_view(changed), 3) > 1e-6);
        CHECK(frame_difference<double>(x0, to_view(changed), 4) > 1e-12); // through frame 3 at the second site
        CHECK(frame_difference<double>(x0, to_view(changed), 5) > 1e-15); // and frame 4 at the third
    }
    TEST_CASE("identical frames give identical estimates") {
        small_baseline_run<double> run;
        run.phi.conditioning = 0;
        auto z = run.noise();
        for (std::size_t i = 1; i < run.frames; ++i) {
            copy(to_view(z)[i], in_view<double, 3>(to_view(z)[0]));
        }
        auto const x0 = run.estimate(pix2video{}, z, 3);
        for (std::size_t i = 1; i < run.frames; ++i) {
            for (std::size_t e = 0; e < 3 * 64; ++e) {
                CHECK(x0.data()[i * 3 * 64 + e] == doctest::Approx(x0.data()[e]).epsilon(1e-13));
            }
        }
    }
    TEST_CASE("layers decide who takes part and outside the window every frame is by itself") {
        small_baseline_run<double> run;
        auto const z = run.noise();
        auto const x0 = run.estimate(pix2video{}, z, 3);
        run.settings.layers = [](attention_site const& site, std::uint32_t branch) {
            return is_in_decoder(site, branch) && branch == 1;
        };
        auto const conditional = run.estimate(pix2video{}, z, 3);
        run.settings.layers = [](attention_site const&, std::uint32_t) { return false; };
        auto const nobody = run.estimate(pix2video{}, z, 3);
        CHECK(frame_difference<double>(x0, to_view(conditional), 3) > 1e-3);
        CHECK(frame_difference<double>(conditional, to_view(nobody), 3) > 1e-3);
        run.settings.layers = is_in_decoder;
        run.settings.window_end = 0.3; // Sigma 3 belongs to the second of three steps.
        auto const outside = run.estimate(pix2video{}, z, 3);
        for (std::size_t i = 0; i < run.frames; ++i) {
            CHECK(frame_difference<double>(outside, to_view(nobody), i) == 0);
        }
    }
    TEST_CASE_TEMPLATE("it keeps the laws of sequence methods with every sampler", Real, float, double) {
        auto const maps = random_scene(33, 5, {32, 32}, 3);
        layered_denoiser<Real> const phi;
        render_settings<Real> settings = render_settings<Real>::plain();
        settings.steps = 3;
        for (auto const method : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            settings.sampler = method;
            CHECK(check_sequence_method_laws(pix2video{}, phi, to_uv_view(maps), settings).text() == "");
        }
    }
    TEST_CASE("a run of one frame is the per-frame baseline") {
        auto const maps = random_scene(33, 1, {32, 32}, 3);
        layered_denoiser<double> const phi;
        auto settings = baseline_settings(few_steps());
        auto const z = render<pix2video>(phi, to_uv_view(maps), {.settings = settings}).z;
        auto const alone = render(phi, to_uv_view(maps), {.settings = per_frame(settings, noise_kind::fixed)}).z;
        CHECK(std::equal(z.begin(), z.end(), alone.begin()));
    }
    TEST_CASE("keyframes are not asked for and no correspondence is compiled") {
        auto const maps = random_scene(33, 2, {32, 32}, 3);
        layered_denoiser<double> const phi;
        auto settings = few_steps();
        settings.keyframes.count = 99; // more than there are
        auto const make_map = [&](grid_extents grid) {
            FAIL("no map is needed");
            return texel_grid(to_uv_view(maps), grid);
        };
        auto const result =
            render<pix2video, texel_grid>(phi, to_uv_view(maps), {.settings = settings, .make_map = make_map});
        CHECK(result.report.coverage.empty());
    }
    TEST_CASE("latents are normalised as the settings say") {
        auto const maps = random_scene(33, 3, {32, 32}, 1);
        layered_denoiser<double> const phi;
        auto settings = few_steps();
        auto const with = render<pix2video>(phi, to_uv_view(maps), {.settings = settings}).z;
        settings.normalization.enabled = false;
        auto const without = render<pix2video>(phi, to_uv_view(maps), {.settings = settings}).z;
        CHECK(frame_difference<double>(with, to_view(without), 0) < 1e-9); // the frame that gives the statistics
        CHECK(frame_difference<double>(with, to_view(without), 2) > 1e-6);
    }
    TEST_CASE("the observer can end the run") {
        auto const maps = random_scene(33, 3, {32, 32}, 3);
        layered_denoiser<double> const phi;
        std::size_t calls = 0;
        auto const result = render<pix2video>(
            phi, to_uv_view(maps), {.settings = few_steps(), .observer = [&](progress const&) { return ++calls < 5; }});
        CHECK(result.is_cancelled);
        CHECK(calls == 5);
    }
    TEST_CASE("a denoiser that does not run its processor is refused by site and branch") {
        auto const maps = random_scene(33, 3, {32, 32}, 3);
        deaf phi;
        phi.grid = {8, 8};
        CHECK_THROWS_WITH_AS(render<pix2video>(phi, to_uv_view(maps), {.settings = few_steps()}),
                             "sequence_denoiser: features of frames at site decoder.attn1 of branch 0 are missing, "
                             "expected the denoiser to run its processor there",
                             value_error);
    }
}
