// SPDX-License-Identifier: MIT
// [GR alg. 1] What is planned is what is then measured, on the heap and in products.
#include <genrender/pipeline/memory_plan.hpp>

#include "../support/counted_memory.hpp"
#include "../support/random_scene.hpp"
#include "../support/wide_denoiser.hpp"

#include <genrender/pipeline/render.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <vector>

using namespace genrender;
using testing::counted_memory;
using testing::wide_denoiser;

namespace {

render_settings<float> two_steps() {
    render_settings<float> settings = render_settings<float>::plain();
    settings.steps = 2;
    settings.keyframes.count = 3;
    return settings;
}

/// A run of which all is known: one site of 6 tokens and 10 channels that takes part, one of 24 tokens that does not.
run_description described_run() {
    run_description run;
    run.frames = 20;
    run.latent_channels = 4;
    run.latent_grid = {4, 6};
    run.branches = 2;
    run.sites = {{"in", network_kind::denoising, network_part::encoder, {4, 6}, 5},
                 {"out", network_kind::denoising, network_part::decoder, {2, 3}, 10}};
    run.map_grid = {16, 24};
    return run;
}

/// What a call takes.
std::size_t bytes_of_a_call(wide_denoiser const& phi, std::uint32_t frame_count) {
    auto const z = latents<float>::from_shape({frame_count, 4, phi.grid.height, phi.grid.width});
    auto x0 = z;
    std::vector<frame_index> frames;
    for (std::uint32_t i = 0; i < frame_count; ++i) {
        frames.push_back({i});
    }
    plain_attention const plain;
    return counted_memory::peak_of([&] { phi(to_view(x0), to_view(z), 1.0F, frames, plain); });
}

/// A scene of twelve frames again and again.
uv_maps long_scene(std::size_t frames) {
    auto const once = testing::random_scene(33, 12, {32, 32}, 3);
    uv_maps maps(frames, once.grid());
    for (std::size_t i = 0; i < frames; ++i) {
        copy(to_view(maps.uv)[i], to_view(once.uv)[i % 12]);
        copy(to_view(maps.object)[i], to_view(once.object)[i % 12]);
        copy(to_view(maps.coverage)[i], to_view(once.coverage)[i % 12]);
    }
    return maps;
}

struct planned_and_measured {
    memory_plan plan;
    std::size_t measured;
    double error() const {
        return std::abs(static_cast<double>(plan.bytes.peak) - static_cast<double>(measured)) /
               static_cast<double>(measured);
    }
};

planned_and_measured compare(std::size_t frames, render_settings<float> const& settings) {
    auto const maps = long_scene(frames);
    wide_denoiser const phi;
    auto run = describe_run(phi, to_uv_view(maps));
    run.network_bytes = bytes_of_a_call(phi, 2) - bytes_of_a_call(phi, 1);
    run.call_bytes = bytes_of_a_call(phi, 1) - *run.network_bytes;
    return {plan_memory(run, settings),
            counted_memory::peak_of([&] { render(phi, to_uv_view(maps), {.settings = settings}); })};
}

} // namespace

TEST_SUITE("pipeline/memory_plan") {
    TEST_CASE("bytes of latents and kept features are counted by hand") {
        auto settings = two_steps();
        auto run = described_run();
        auto const plan = plan_memory(run, settings);
        CHECK(plan.bytes.bank == 3 * 3 * 60 * 2 * sizeof(float)); // K, V and F of 3 keyframes, 2 branches
        CHECK(plan.bytes.keyframe_latents == 2 * 3 * 96 * sizeof(float));
        CHECK(plan.bytes.latents == 3 * 20 * 96 * sizeof(float)); // z, x0 and the result
        CHECK(plan.bytes.background == 20 * 24);
        CHECK(plan.bytes.maps == 20 * 384 * 13);
        CHECK(plan.bytes.network == 3 * (5 * 120 - 3 * 60) * sizeof(float)); // f, Q, K, V, F but for what is kept
        CHECK(plan.bytes.residuals == 0);
        CHECK(plan.bytes.peak > plan.bytes.latents + plan.bytes.bank + plan.bytes.correspondence);
        settings.keyframe_storage = feature_storage::f16;
        CHECK(2 * plan_memory(run, settings).bytes.bank == plan.bytes.bank);
        run.residual_bytes = 1000;
        CHECK(plan_memory(run, settings).bytes.residuals == 3000);
        settings.reuses_keyframes = false;
        CHECK(plan_memory(run, settings).bytes.residuals == 0);
        settings.sampler = sampler_kind::heun;
        CHECK(plan_memory(run, settings).bytes.latents == 5 * 20 * 96 * sizeof(float)); // Heun's z and x0 there, too
        // Two steps draw six keyframes or fewer; their matches with 20 frames fit into one chunk.
        CHECK(plan.bytes.correspondence == footprint_map<2>::expected_bytes(20, 6));
        CHECK(plan.bytes.matching > match_cache::chunk_bytes);
        CHECK(plan.bytes.matching <= match_cache::chunk_bytes + 6 * frame_samples<2>::expected_bytes(384, 64));
        settings.correspondence.kind = correspondence_kind::texel_grid;
        CHECK(plan_memory(run, settings).bytes.matching == 0);
    }
    TEST_CASE("counts of points take plans of keyframes, and plans without eq. 6") {
        auto settings = two_steps();
        auto const run = described_run();
        auto const plain = plan_memory(run, settings).bytes;
        settings.injection.counts_points = true;
        auto const counted = plan_memory(run, settings).bytes;
        CHECK(counted.blend_plans == 4 * plain.blend_plans); // of 3 keyframes beside those of a call of 1 frame
        settings.injection.post_attention = false;
        CHECK(plan_memory(run, settings).bytes.blend_plans == counted.blend_plans);
        settings.injection.counts_points = false;
        CHECK(plan_memory(run, settings).bytes.blend_plans == 0);
    }
    TEST_CASE("a consensus is counted by hand and has no bytes where there is none") {
        auto settings = two_steps();
        auto run = described_run();
        auto const without = plan_memory(run, settings);
        CHECK(without.bytes.consensus == 0);
        CHECK(without.work.consensus_bytes == 0);
        settings.consensus.enabled = true;
        settings.consensus.agrees_on_background = false;
        settings.consensus.sources = {
            .count = 3, .drawing = keyframe_drawing::fixed, .frames = {{2}, {5}, {7}}, .seed = 0};
        settings.correspondence.kind = correspondence_kind::texel_grid;
        run.calls_at_once = 2;
        auto const plan = plan_memory(run, settings);
        // Three estimates of 96 values, and two frames under way with a plan of 25 offsets, room for 72 entries and averages.
        CHECK(plan.bytes.consensus == 4 * (3 * 96 + 2 * (25 + 2 * 128 + 96)));
        CHECK(plan.bytes.background == 2 * 20 * 24); // the mask and the shares of cells
        // Both steps begin within the window: at 0 and at a half.
        CHECK(plan.work.consensus_matches == 2 * 20 * 3 * 24);
        CHECK(plan.work.consensus_bytes == 2 * 96 * 4.0 * (2 * 3 + 20 * (2 * 3 + 5)));
        // One that agrees on the background has a mask of its own and looks up no more cells.
        settings.consensus.agrees_on_background = true;
        CHECK(plan_memory(run, settings).bytes.background == 3 * 20 * 24);
        CHECK(plan_memory(run, settings).work.consensus_matches == 2 * 20 * 3 * 24);
        settings.consensus.agrees_on_background = false;
        settings.consensus.window_end = 0.5;
        CHECK(plan_memory(run, settings).work.consensus_matches == 20 * 3 * 24);
        settings.consensus.fades_at_silhouettes = false;
        CHECK(plan_memory(run, settings).bytes.background == 20 * 24);
        // By footprints there is a map of the latents' grid, too.
        settings.correspondence.kind = correspondence_kind::footprint;
        CHECK(plan_memory(run, settings).bytes.correspondence ==
              without.bytes.correspondence + footprint_map<2>::expected_bytes(20, 24));
        CHECK(plan_memory(run, settings).bytes.matching > without.bytes.matching);
        // With all frames as sources it grows with their number.
        settings.consensus.sources = {.count = 100, .drawing = keyframe_drawing::uniform, .frames = {}, .seed = 0};
        auto const over_all = plan_memory(run, settings).bytes.consensus;
        run.frames = 40;
        // Twenty more estimates, and twenty more entries a cell in two plans.
        CHECK(plan_memory(run, settings).bytes.consensus == over_all + 20 * 4 * (96 + 2 * 2 * 24));
    }
    TEST_CASE("[GR eq. 3, 5] FLOPs of attention are counted by hand") {
        auto settings = two_steps();
        auto const run = described_run();
        auto const plan = plan_memory(run, settings);
        auto const outer = 4.0 * 24 * 24 * 5;
        auto const inner = 4.0 * 6 * 6 * 10;
        // 2 steps, 2 branches: 20 frames and 3 keyframes run the outer site alone; at the inner one frames attend to
        // themselves and 3 keyframes, keyframes to 3.
        CHECK(plan.work.attention_flops == 4 * (23 * outer + (20 * 4 + 3 * 3) * inner));
        CHECK(plan.work.plain_attention_flops == 4 * 20 * (outer + inner));
        CHECK(plan.work.attention_ratio() > 1);
        CHECK(plan.work.projection_flops == 4 * 23 * 6.0 * (24 * 25 + 6 * 100));
        CHECK(plan.work.denoised_frames == frames_to_denoise(settings, 20));
        CHECK(plan.work.noise_values == 20 * 96);
        CHECK(plan.work.mixed_bytes == 4 * 20 * 60.0 * 4 * 5);
        settings.injection.keeps_own_copy = false; // keyframes among the frames leave a block out
        CHECK(plan_memory(run, settings).work.attention_flops == plan.work.attention_flops - 4 * 3 * inner);
        settings.injection.pre_attention = false;
        CHECK(plan_memory(run, settings).work.attention_flops == 4 * 23 * (outer + inner));
        settings.window_end = 0;
        auto const plain = plan_memory(run, settings);
        CHECK(plain.work.attention_ratio() == 1);
        CHECK(plain.bytes.bank == 0);
        CHECK(plain.work.mixed_bytes == 0);
    }
    TEST_CASE("the plan's attention is what the denoiser is then asked for") {
        auto const maps = testing::random_scene(33, 6, {32, 32}, 3);
        wide_denoiser const phi;
        for (auto const method : {sampler_kind::euler, sampler_kind::heun}) {
            for (auto const keeps_own_copy : {true, false}) {
                auto settings = two_steps();
                settings.sampler = method;
                settings.injection.keeps_own_copy = keeps_own_copy;
                phi.attention_flops = 0;
                render(phi, to_uv_view(maps), {.settings = settings});
                auto const plan = plan_memory(describe_run(phi, to_uv_view(maps)), settings);
                CHECK(plan.work.attention_flops == static_cast<double>(phi.attention_flops));
            }
        }
    }
    TEST_CASE("the peak is within 5 % of the heap's and grows by what frames take alone") {
        if (!counted_memory::is_counted) {
            MESSAGE("the heap is not counted here");
            return;
        }
        auto settings = two_steps();
        for (auto const method : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            settings.sampler = method;
            auto const few = compare(24, settings);
            auto const many = compare(240, settings);
            MESSAGE("planned ", few.plan.bytes.peak, " and ", many.plan.bytes.peak, " bytes, measured ", few.measured,
                    " and ", many.measured);
            CHECK(few.error() < 0.05);
            CHECK(many.error() < 0.05);
            // Besides latents and what stands for tokens, matches are kept as far as they may.
            auto const growing = [](planned_bytes const& bytes) {
                return static_cast<double>(bytes.of_frames() - bytes.maps + bytes.matching);
            };
            auto const grown = static_cast<double>(many.measured) - static_cast<double>(few.measured);
            CHECK(grown < 1.1 * (growing(many.plan.bytes) - growing(few.plan.bytes)));
        }
        settings.keyframe_storage = feature_storage::bf16;
        CHECK(compare(24, settings).error() < 0.05);
        settings = two_steps();
        settings.window_end = 0;
        CHECK(compare(24, settings).error() < 0.05);
    }
    TEST_CASE("with a consensus the peak is within 5 % of the heap's as well") {
        if (!counted_memory::is_counted) {
            MESSAGE("the heap is not counted here");
            return;
        }
        auto settings = two_steps();
        settings.consensus.enabled = true;
        for (auto const alone : {false, true}) { // after the passes of a method, or as the largest part of a run
            settings.window_end = alone ? 0.0F : 1.0F;
            for (std::size_t const frames : {24U, 240U}) {
                auto const both = compare(frames, settings);
                MESSAGE("planned ", both.plan.bytes.peak, " bytes, measured ", both.measured);
                CHECK(both.error() < 0.05);
            }
        }
    }
}
