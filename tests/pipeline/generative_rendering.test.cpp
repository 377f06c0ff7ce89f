// SPDX-License-Identifier: MIT
// [GR alg. 1: the body of the loop] The paper's method as a model of sequence_method; its numbers are proved by the
// sequence denoiser's test.
#include <genrender/pipeline/generative_rendering.hpp>

#include "../baselines/layered_denoiser.hpp"
#include <genrender/testing/analytic_denoiser.hpp>
#include "../support/fixed_memory_denoiser.hpp"
#include "../support/random_scene.hpp"
#include <genrender/testing/sequence_method_laws.hpp>

#include <genrender/pipeline/render.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

using namespace genrender;

namespace {

render_settings<double> four_steps() {
    render_settings<double> settings = render_settings<double>::plain();
    settings.steps = 4;
    settings.keyframes.count = 2;
    return settings;
}

} // namespace

TEST_SUITE("pipeline/generative_rendering") {
    TEST_CASE_TEMPLATE("[GR alg. 1] it keeps the laws of sequence methods with every sampler", Real, float, double) {
        auto const maps = testing::random_scene(33, 5, {32, 32}, 3);
        testing::analytic_denoiser<Real> const phi{.grid = {8, 8}, .attention = Real(0.5), .guidance_branches = 2};
        render_settings<Real> settings = render_settings<Real>::plain();
        settings.steps = 3;
        settings.keyframes.count = 2;
        settings.window_begin = Real(0.3);
        for (auto const method : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            settings.sampler = method;
            CHECK(testing::check_sequence_method_laws(generative_rendering{}, phi, to_uv_view(maps), settings).text() ==
                  "");
        }
    }
    TEST_CASE_TEMPLATE("features of keyframes may lie in memory that each keyframe pass uses again", Engine,
                       testing::graph_in_fixed_memory, testing::calls_in_fixed_memory) {
        auto const maps = testing::random_scene(33, 5, {32, 32}, 3);
        auto settings = four_steps();
        settings.sampler = sampler_kind::heun;
        settings.keyframe_storage =
            std::is_same_v<Engine, testing::calls_in_fixed_memory> ? feature_storage::f16 : feature_storage::same;
        Engine const fixed{{.grid = {8, 8}, .attention = 0.5, .guidance_branches = 2}, true};
        Engine const fresh{{.grid = {8, 8}, .attention = 0.5, .guidance_branches = 2}, false};
        auto const in_fixed = render(fixed, to_uv_view(maps), {.settings = settings, .loop = threaded_loop(2)}).z;
        auto const in_fresh = render(fresh, to_uv_view(maps), {.settings = settings}).z;
        CHECK(std::equal(in_fixed.begin(), in_fixed.end(), in_fresh.begin()));
        std::size_t const stacks = std::is_same_v<Engine, testing::calls_in_fixed_memory> ? 3 : 2;
        CHECK(fixed.memory.kept == 7 * 2 * stacks); // evaluations, branches of the one place that takes part
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
        settings.injection.pre_attention = false;
        CHECK(has_keyframes(settings, 0));
        settings.injection.post_attention = false;
        CHECK(!has_keyframes(settings, 0));
        settings.injection.pre_attention = true;
        CHECK(has_keyframes(settings, 0));
    }
    TEST_CASE("correspondences are for post-attention injection alone") {
        auto settings = four_steps();
        CHECK(generative_rendering{}.uses_correspondence(settings));
        settings.injection.post_attention = false;
        CHECK(!generative_rendering{}.uses_correspondence(settings));
    }
    TEST_CASE("[GR alg. 1] keys and values of keyframes are projected once per step and layer") {
        auto const maps = testing::random_scene(33, 5, {32, 32}, 3);
        testing::layered_denoiser<double> const phi;
        auto const settings = four_steps();
        render(phi, to_uv_view(maps), {.settings = settings});
        for (std::size_t site = 0; site < phi.weights.size(); ++site) {
            // 4 steps, 2 branches: 5 frames, and 2 keyframes that no frame projects again.
            CHECK(phi.weights[site].keys == 4 * 2 * (5 + 2));
            CHECK(phi.weights[site].values == 4 * 2 * (5 + 2));
            CHECK(phi.weights[site].queries == 4 * 2 * (5 + 2));
        }
    }
    TEST_CASE("correspondence is used where a step has keyframes and mixes them in") {
        auto settings = four_steps();
        CHECK(generative_rendering{}.uses_correspondence(settings));
        settings.window_begin = settings.window_end = 0.5;
        CHECK_FALSE(generative_rendering{}.uses_correspondence(settings));
        settings.window_end = 1;
        settings.injection.post_attention = false;
        CHECK_FALSE(generative_rendering{}.uses_correspondence(settings));
    }
    TEST_CASE("features kept in 16 bits change the frames by little") {
        auto const maps = testing::random_scene(33, 5, {32, 32}, 3);
        testing::layered_denoiser<float> const phi;
        auto const run = [&](feature_storage storage) {
            render_settings<float> settings = render_settings<float>::plain();
            settings.steps = 3;
            settings.keyframes.count = 2;
            settings.keyframe_storage = storage;
            return render(phi, to_uv_view(maps), {.settings = settings}).z;
        };
        auto const exact = run(feature_storage::same);
        for (auto const& [storage, unit] :
             {std::pair(feature_storage::f16, 0x1p-11), {feature_storage::bf16, 0x1p-8}}) {
            auto const rounded = run(storage);
            double worst = 0;
            double largest = 0;
            for (std::size_t e = 0; e < exact.size(); ++e) {
                worst = std::max(worst, static_cast<double>(std::abs(rounded.data()[e] - exact.data()[e])));
                largest = std::max(largest, static_cast<double>(std::abs(exact.data()[e])));
            }
            CHECK(worst > 0);
            CHECK(worst < 32 * unit * largest); // three steps of a network that amplifies
        }
    }
}
