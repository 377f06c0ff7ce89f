// SPDX-License-Identifier: MIT
// [GR alg. 1: Phi] Every law of denoisers can be broken, and is told by its sentence.
#include <genrender/testing/denoiser_laws.hpp>

#include "broken_laws.hpp"
#include "flawed_denoiser.hpp"

#include <genrender/pipeline/render.hpp>
#include <genrender/testing/analytic_denoiser.hpp>

#include "../support/random_scene.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

TEST_SUITE("testing/denoiser_laws") {
    using namespace genrender;
    using namespace genrender::testing;

    namespace {

    using names = std::vector<std::string>;

    law_report report_on(flaw what) {
        flawed_denoiser const phi{what};
        return check_denoiser_laws(phi, 1.5F);
    }

    /// A denoiser whose graph is static: it asks for inputs and hands over features, once more than it should if told.
    struct asking_denoiser : analytic_denoiser<float> {
        bool asks_twice = false;
        template <feature_io_processor<host_features<float>, float> Processor>
        void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                        std::span<frame_index const> frames, Processor& processor) const {
            auto const asks = [&](auto& call) {
                auto const F = plain_attention{}(call);
                if (inputs_at<host_features<float>, float>(processor, call.place(), frames).is_recorded) {
                    for (int i = 0; i < (asks_twice ? 2 : 1); ++i) {
                        record_features(processor, call.place(), call.f(), F);
                    }
                }
                return F;
            };
            analytic_denoiser<float>::operator()(x0, z, sigma, frames, asks);
        }
    };

    } // namespace

    TEST_CASE("a denoiser written from the header alone keeps the laws and renders") {
        second_engine::denoiser const phi;
        CHECK(check_denoiser_laws(phi, 1.5F).text() == "");
        CHECK(check_denoiser_laws(phi, 0.01F, {.frames = {{4}, {1}}, .threads = 1}).text() == "");
        auto const maps = random_scene(33, 3, {16, 24}, 2);
        render_settings<float> settings;
        settings.steps = 2;
        settings.keyframes.count = 2;
        auto const z = render(phi, to_uv_view(maps), {.settings = settings}).z;
        CHECK(std::all_of(z.begin(), z.end(), [](float x) { return is_finite(x); }));
    }
    TEST_CASE("a denoiser that can stop and lends keeps them") { CHECK(report_on(flaw::none).text() == ""); }
    TEST_CASE("a denoiser of a static graph is checked by what it asks and hands over") {
        asking_denoiser phi{{.grid = {2, 3}, .attention = 0.3F}};
        CHECK(check_denoiser_laws(phi, 1.5F).text() == "");
        phi.asks_twice = true;
        CHECK(
            check_denoiser_laws(phi, 1.5F).text() ==
            "denoiser: every site is run once per branch and call, with all frames at once: found 2 runs of site 0 of "
            "branch 0, expected 1\n");
    }
    TEST_CASE("each flaw is told by the law that it breaks") {
        CHECK(broken_laws(report_on(flaw::has_no_branch)) == names{"denoiser: there are latents and a branch"});
        CHECK(broken_laws(report_on(flaw::has_site_without_channels)) ==
              names{"denoiser: sites tell their grid and channels"});
        CHECK(broken_laws(report_on(flaw::leaves_a_frame_unwritten)) ==
              names{"denoiser: all of x0 is written and finite"});
        CHECK(broken_laws(report_on(flaw::minds_the_thread)) ==
              names{"denoiser: calls for different frames may run at the same time"});
        CHECK(broken_laws(report_on(flaw::lets_frames_meet)) ==
              names{"denoiser: with plain attention a frame does not depend on the others of its stack"});
        CHECK(broken_laws(report_on(flaw::tells_other_frames)).front() ==
              "denoiser: frames() of a call are those of the denoiser's call");
        CHECK(broken_laws(report_on(flaw::changes_z)).front() == "denoiser: z is not changed");
        CHECK(broken_laws(report_on(flaw::counts_its_calls)).front() == "denoiser: equal arguments give equal results");
        CHECK(broken_laws(report_on(flaw::runs_a_site_twice)).front() ==
              "denoiser: every site is run once per branch and call, with all frames at once");
        CHECK(broken_laws(report_on(flaw::leaves_a_site_out)).front() ==
              "denoiser: every site is run once per branch and call, with all frames at once");
        CHECK(broken_laws(report_on(flaw::names_a_place_that_is_none)).front() ==
              "denoiser: the places that are run are those of sites() and branches()");
        CHECK(broken_laws(report_on(flaw::stops_too_early)) ==
              names{"stoppable_denoiser: every site is run once per branch and call, with all frames at once"});
        CHECK(broken_laws(report_on(flaw::changes_z_when_stopped)).front() == "stoppable_denoiser: z is not changed");
        CHECK(broken_laws(report_on(flaw::lends_what_is_wrong)) ==
              names{"residual_lender: what is lent changes no estimate"});
        CHECK(broken_laws(report_on(flaw::lends_to_any_z)) ==
              names{"residual_lender: what is lent is not used for another z"});
    }
    TEST_CASE("sentences say what was found where and what was expected") {
        CHECK(report_on(flaw::has_no_branch).text() ==
              "denoiser: there are latents and a branch: found latents [2, 4, 6] and 0 branches, expected extents and "
              "branches of at least 1\n");
        CHECK(report_on(flaw::tells_other_frames).violations.front() ==
              "denoiser: frames() of a call are those of the denoiser's call: found [2, 1, 0], expected those that "
              "operator() was given, in their order");
        auto const sentence = report_on(flaw::lets_frames_meet).violations.front();
        CHECK(sentence.find(": found frame 0 alone, x0[0, 0, 0, 1] = ") != std::string::npos);
        CHECK(sentence.find(" up to rounding") != std::string::npos);
    }
    TEST_CASE("a trial has at least two frames") {
        CHECK_THROWS_WITH_AS(check_denoiser_laws(second_engine::denoiser{}, 1.5F, {.frames = {{0}}}),
                             "check_denoiser_laws: trial.frames.size() is 1, expected at least 2 frames", value_error);
    }
    TEST_CASE("a thread that minds is not minded where there is one") {
        flawed_denoiser const phi{flaw::minds_the_thread};
        CHECK(check_denoiser_laws(phi, 1.5F, {.threads = 1}).text() == "");
    }
}
