// SPDX-License-Identifier: MIT
// [GR sec. 4: Per-Frame] The baseline leaves every frame to itself.
#include <genrender/baselines/per_frame.hpp>

#include <genrender/testing/analytic_denoiser.hpp>
#include "../support/random_scene.hpp"

#include <genrender/pipeline/render.hpp>

#include <doctest/doctest.h>

#include <array>

using namespace genrender;

TEST_SUITE("baselines/per_frame") {
    TEST_CASE(
        "[GR sec. 4: Per-Frame] a frame of the baseline equals the frame sampled without any library in between") {
        auto const maps = testing::random_scene(1, 4, {16, 16}, 2);
        testing::analytic_denoiser<double> const phi{.grid = {8, 8}, .attention = 0.5};
        render_settings<double> settings = render_settings<double>::plain();
        settings.steps = 5;
        auto const [all, report, is_cancelled] = render(phi, to_uv_view(maps), {.settings = per_frame(settings)});

        auto z = latents<double>::from_shape({1, 3, 8, 8});
        for (std::uint32_t t = 0; t < 64; ++t) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                z(0, c, t / 8, t % 8) = normal_value(0, random_stream::frame_noise, {2, t, c});
            }
        }
        auto const sigmas = karras_schedule<double>(5);
        z *= sigmas[0];
        plain_attention const plain;
        auto const D = [&](latents<double> const& noisy, double sigma) {
            auto x0 = noisy;
            phi(to_view(x0), to_view(noisy), sigma, std::array{frame_index{2}}, plain);
            return x0;
        };
        z = euler(D, z, sigmas);
        for (std::size_t e = 0; e < z.size(); ++e) {
            CHECK(all.data()[2 * z.size() + e] == doctest::Approx(z.data()[e]).epsilon(1e-12));
        }
        CHECK(report.coverage.empty());
        CHECK(report.skipped_frames.empty());
    }
    TEST_CASE("noise is independent unless asked otherwise and the rest of the settings stays") {
        render_settings<float> settings = render_settings<float>::plain();
        settings.steps = 7;
        settings.noise.seed = 9;
        auto const baseline = per_frame(settings);
        CHECK(baseline.noise.kind == noise_kind::independent);
        CHECK(baseline.noise.seed == 9);
        CHECK(baseline.steps == 7);
        CHECK(!baseline.normalization.enabled);
        CHECK(per_frame(settings, noise_kind::fixed).noise.kind == noise_kind::fixed);
    }
}
