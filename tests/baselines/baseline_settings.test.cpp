// SPDX-License-Identifier: MIT
// [GR sec. 4: Baselines] What the paper changes for the methods it compares with.
#include <genrender/baselines/baseline_settings.hpp>

#include <doctest/doctest.h>

using namespace genrender;

TEST_SUITE("baselines/baseline_settings") {
    TEST_CASE_TEMPLATE("[GR sec. 4: Baselines] every frame starts from the same noise and latents are not normalised",
                       Real, float, double) {
        render_settings<Real> settings;
        settings.consensus.enabled = true;
        auto const baseline = baseline_settings(settings);
        CHECK(baseline.noise.kind == noise_kind::fixed);
        CHECK(!baseline.normalization.enabled);
        CHECK(!baseline.consensus.enabled);
    }
    TEST_CASE("noise of another kind can be asked for") {
        CHECK(baseline_settings(render_settings<float>{}, noise_kind::uv).noise.kind == noise_kind::uv);
    }
    TEST_CASE("the rest of the settings stays") {
        render_settings<double> settings;
        settings.steps = 7;
        settings.noise.seed = 9;
        settings.sampler = sampler_kind::heun;
        settings.keyframes.count = 2;
        settings.window_end = 0.5;
        auto const baseline = baseline_settings(settings);
        CHECK(baseline.steps == 7);
        CHECK(baseline.noise.seed == 9);
        CHECK(baseline.sampler == sampler_kind::heun);
        CHECK(baseline.keyframes.count == 2);
        CHECK(baseline.window_end == 0.5);
    }
}
