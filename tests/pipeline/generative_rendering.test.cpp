// SPDX-License-Identifier: MIT
// [GR alg. 1: the body of the loop] The paper's method as a model of sequence_method; its numbers are proved by the
// sequence denoiser's test.
#include <genrender/pipeline/generative_rendering.hpp>

#include "../support/analytic_denoiser.hpp"
#include "../support/random_scene.hpp"
#include "../support/sequence_method_laws.hpp"

#include <doctest/doctest.h>

using namespace genrender;

namespace {

render_settings<double> four_steps() {
    render_settings<double> settings;
    settings.steps = 4;
    settings.keyframes.count = 2;
    return settings;
}

} // namespace

TEST_SUITE("pipeline/generative_rendering") {
    TEST_CASE_TEMPLATE("[GR alg. 1] it keeps the laws of sequence methods with every sampler", Real, float, double) {
        auto const maps = testing::random_scene(33, 5, {32, 32}, 3);
        testing::analytic_denoiser<Real> const phi{.grid = {8, 8}, .attention = Real(0.5), .guidance_branches = 2};
        render_settings<Real> settings;
        settings.steps = 3;
        settings.keyframes.count = 2;
        settings.window_begin = Real(0.3);
        for (auto const method : {sampler::euler, sampler::heun, sampler::dpmpp_2m}) {
            settings.method = method;
            testing::check_sequence_method_laws(generative_rendering{}, phi, maps, settings);
        }
    }
    TEST_CASE("keyframes are those of the step and none outside the window") {
        auto settings = four_steps();
        settings.window_begin = 0.25;
        settings.window_end = 0.75;
        generative_rendering const method;
        CHECK(method.keyframes(settings, 9, 0).empty());
        CHECK(method.keyframes(settings, 9, 1) == draw_keyframes(settings.keyframes, 9, 1));
        CHECK(method.keyframes(settings, 9, 2) == draw_keyframes(settings.keyframes, 9, 2));
        CHECK(method.keyframes(settings, 9, 3).empty());
    }
    TEST_CASE("without injection there are no keyframes") {
        auto settings = four_steps();
        settings.pre_attention = false;
        CHECK(has_keyframes(settings, 0));
        settings.post_attention = false;
        CHECK(!has_keyframes(settings, 0));
        settings.pre_attention = true;
        CHECK(has_keyframes(settings, 0));
    }
    TEST_CASE("correspondences are for post-attention injection alone") {
        auto settings = four_steps();
        CHECK(generative_rendering{}.uses_correspondence(settings));
        settings.post_attention = false;
        CHECK(!generative_rendering{}.uses_correspondence(settings));
    }
}
