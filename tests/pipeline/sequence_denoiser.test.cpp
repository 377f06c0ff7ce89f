// SPDX-License-Identifier: MIT
// [GR alg. 1] The body of the loop against a plain second writing of it.
#include <genrender/pipeline/sequence_denoiser.hpp>

#include "../support/plain_algorithm.hpp"
#include "../support/random_scene.hpp"
#include "../support/stacked_branches.hpp"

#include <genrender/correspondence/texel_grid.hpp>
#include <genrender/maps/background_mask.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

using namespace genrender;

TEST_SUITE("pipeline/sequence_denoiser") {
    namespace {

    /// A scene of six frames on 8 x 8 latents with everything a sequence denoiser refers to.
    template <class Real>
    struct small_run {
        static constexpr std::size_t objects = 3;
        static constexpr std::size_t T = 12;
        uv_maps maps = testing::random_scene(21, 6, {32, 32}, objects);
        testing::analytic_denoiser<Real> phi{.grid = {8, 8}, .attention = Real(0.6), .guidance_branches = 2};
        render_settings<Real> settings = render_settings<Real>::plain();
        std::vector<Real> sigmas{8, 3, 1, 0};
        tensor<std::uint8_t, 3> background = background_mask(to_uv_view(maps), phi.grid);
        correspondence_set<texel_grid> grids;
        sequential_loop loop;
        progress_meter meter{3, 1000, {}};
        render_report report;
        report_writer writer{report};

        small_run() {
            settings.steps = 3;
            settings.keyframes.count = 3;
            settings.normalization.enabled = false;
            grids.add(phi.grid, [&](grid_extents grid) { return texel_grid(to_uv_view(maps), grid, {.T = T}); });
        }

        latents<Real> noise() const {
            auto z = latents<Real>::from_shape({6, 3, 8, 8});
            for (std::size_t e = 0; e < z.size(); ++e) {
                z.data()[e] =
                    static_cast<Real>(normal_value(5, random_stream::test, {static_cast<std::uint32_t>(e), 0, 0}));
            }
            return z;
        }

        latents<Real> estimate(latents<Real> const& z, Real sigma) {
            return sequence_denoiser(phi, grids, to_view(std::as_const(background)), std::span<Real const>(sigmas),
                                     settings, loop, meter, writer)(z, sigma);
        }
    };

    /// A denoiser that forgets its processor.
    struct deaf : testing::analytic_denoiser<double> {
        template <class Processor>
        void operator()(strided_view<double, 4> x0, strided_view<double const, 4> z, double,
                        std::span<frame_index const>, Processor&) const {
            copy(x0, in_view<double, 4>(z));
        }
    };

    template <class Real>
    double greatest_difference(latents<Real> const& a, Real const* b) {
        double worst = 0;
        for (std::size_t e = 0; e < a.size(); ++e) {
            worst = std::max(worst, std::abs(static_cast<double>(a.data()[e]) - static_cast<double>(b[e])));
        }
        return worst;
    }

    } // namespace

    TEST_CASE_TEMPLATE("[GR alg. 1] an evaluation equals the plainly written algorithm", Real, float, double) {
        small_run<Real> run;
        auto const z = run.noise();
        for (std::size_t step = 0; step < 3; ++step) {
            auto const sigma = run.sigmas[step];
            auto const KF = draw_keyframes(run.settings.keyframes, 6, step);
            auto const expected =
                testing::plain_algorithm<Real>(run.phi, run.maps, run.objects, run.T, to_view(z), sigma, KF, Real(0.7));
            auto const x0 = run.estimate(z, sigma);
            auto const worst = greatest_difference(x0, expected.data());
            MESSAGE("step ", step, ": greatest difference ", worst);
            CHECK(worst <= 1e-6);
        }
        CHECK(run.report.coverage.at({8, 8}).share() > 0.3);
    }
    TEST_CASE("[GR alg. 1] alpha may depend on step and site and layers decide who takes part") {
        small_run<double> run;
        auto const z = run.noise();
        auto const as_is = run.estimate(z, 3);
        run.settings.alpha = [](std::size_t step, attention_site const& site) {
            CHECK(step == 1);
            CHECK(site.name == "decoder.attn1");
            return 0.2;
        };
        auto const KF = draw_keyframes(run.settings.keyframes, 6, 1);
        auto const expected =
            testing::plain_algorithm<double>(run.phi, run.maps, run.objects, run.T, to_view(z), 3, KF, 0.2);
        CHECK(greatest_difference(run.estimate(z, 3), expected.data()) <= 1e-12);
        // Without layers every frame is left to itself, as outside the window.
        run.settings.layers = [](attention_site const&, std::uint32_t) { return false; };
        auto const nobody = run.estimate(z, 3);
        run.settings.window_end = 0;
        CHECK(greatest_difference(run.estimate(z, 3), nobody.data()) == 0);
        CHECK(greatest_difference(as_is, nobody.data()) > 1e-3);
    }
    TEST_CASE("injection into one guidance branch leaves the other as it is") {
        small_run<double> run;
        auto const z = run.noise();
        auto const both = run.estimate(z, 3);
        run.settings.layers = [](attention_site const& site, std::uint32_t branch) {
            return is_in_decoder(site, branch) && branch == 1;
        };
        auto const conditional = run.estimate(z, 3);
        run.settings.layers = [](attention_site const&, std::uint32_t) { return false; };
        auto const none = run.estimate(z, 3);
        // Branches are mirror images here, so half of the change remains.
        for (std::size_t e = 0; e < z.size(); ++e) {
            CHECK(conditional.data()[e] - none.data()[e] ==
                  doctest::Approx((both.data()[e] - none.data()[e]) / 2).epsilon(1e-9).scale(1));
        }
    }
    TEST_CASE("what an evaluation draws depends on the noise level alone") {
        small_run<double> run;
        auto const z = run.noise();
        auto const once = run.estimate(z, 1);
        run.estimate(z, 8);
        CHECK(greatest_difference(run.estimate(z, 1), once.data()) == 0);
    }
    TEST_CASE("a consensus comes after the method and before normalisation") {
        small_run<double> run;
        auto const z = run.noise();
        auto expected = run.estimate(z, 3);
        run.settings.consensus.enabled = true;
        run.settings.consensus.average = texel_average::plain;
        sequence_run<testing::analytic_denoiser<double>, texel_grid> const alone{&run.phi, &run.grids, &run.settings,
                                                                                 {},       &run.meter, &run.writer};
        auto const open = open_background(to_view(std::as_const(run.background)), 2);
        reach_consensus(alone, to_view(expected), {.background = to_view(open)}, 1);
        CHECK(greatest_difference(run.estimate(z, 3), expected.data()) == 0);
        run.settings.normalization.enabled = true;
        auto before = expected;
        normalize_latents(to_view(expected), to_view(std::as_const(run.background)), run.settings.normalization);
        CHECK(greatest_difference(before, expected.data()) > 1e-3);
        CHECK(greatest_difference(run.estimate(z, 3), expected.data()) == 0);
        // Step 2 of 3 lies behind a window of 60 %.
        run.settings.consensus.window_end = 0.6;
        run.settings.normalization.enabled = false;
        run.settings.consensus.agrees_on_background = false;
        auto const last = run.estimate(z, 1);
        run.settings.consensus.enabled = false;
        CHECK(greatest_difference(run.estimate(z, 1), last.data()) == 0);
    }
    TEST_CASE("a noise level belongs to the step that begins at it") {
        std::vector<double> const sigmas{8, 3, 1, 0};
        std::span<double const> const all(sigmas);
        CHECK(step_at(all, 8) == 0);
        CHECK(step_at(all, 5) == 0);
        CHECK(step_at(all, 3) == 1);
        CHECK(step_at(all, 1) == 2);
        CHECK(step_at(all, 0.1) == 2);
        CHECK(step_at(all, 100) == 0);
    }
    TEST_CASE("a denoiser that does not run its processor is refused by site and branch") {
        small_run<double> run;
        deaf phi;
        phi.grid = run.phi.grid;
        auto const z = run.noise();
        CHECK_THROWS_WITH_AS(sequence_denoiser(phi, run.grids, to_view(std::as_const(run.background)),
                                               std::span<double const>(run.sigmas), run.settings, run.loop, run.meter,
                                               run.writer)(z, 3),
                             "sequence_denoiser: features of keyframes at site decoder.attn1 of branch 0 are missing, "
                             "expected the denoiser to run its processor there",
                             value_error);
    }
    TEST_CASE("estimates that are not finite end the run with a sentence") {
        small_run<double> run;
        auto z = run.noise();
        z(4, 1, 2, 3) = std::nan("");
        run.settings.layers = [](attention_site const&, std::uint32_t) { return false; };
        CHECK_THROWS_WITH_AS(
            run.estimate(z, 3),
            "sequence_denoiser: the denoiser's estimate of frame 4 in step 1 is nan, expected finite latents",
            value_error);
    }

    TEST_CASE("branches that run as one stack give what branches apart give") {
        small_run<float> run;
        testing::stacked_denoiser stacked;
        static_cast<testing::analytic_denoiser<float>&>(stacked) = run.phi;
        auto const z = run.noise();
        auto const apart = run.estimate(z, 3);
        auto const together = [&] {
            return sequence_denoiser(stacked, run.grids, to_view(std::as_const(run.background)),
                                     std::span<float const>(run.sigmas), run.settings, run.loop, run.meter,
                                     run.writer)(z, 3);
        };
        CHECK(greatest_difference(together(), apart.data()) == 0);
        stacked.mixes_up = true;
        CHECK(greatest_difference(together(), apart.data()) > 0.01);
    }
}
