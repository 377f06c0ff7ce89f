// SPDX-License-Identifier: MIT
// What who looks on sees after each step.
#include <genrender/pipeline/finished_step.hpp>

#include "../baselines/layered_denoiser.hpp"
#include "../support/device_denoiser.hpp"
#include "../support/random_scene.hpp"

#include <genrender/pipeline/render.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

using namespace genrender;

TEST_SUITE("pipeline/finished_step") {
    namespace {

    using layered = testing::layered_denoiser<float>;

    /// Latents and estimates after all steps, and the frames.
    struct looked_at {
        std::vector<latents<float>> z;
        std::vector<latents<float>> x0;
        latents<float> frames;
    };
    template <class Phi>
    looked_at look(Phi const& phi, render_settings<float> settings) {
        settings.steps = 3;
        settings.keyframes.count = 2;
        auto const maps = testing::random_scene(33, 3, {16, 16}, 2);
        looked_at seen;
        seen.frames = render(phi, to_uv_view(maps),
                             {.settings = settings,
                              .after_step =
                                  [&](auto const& step) {
                                      CHECK(step.number() == seen.z.size());
                                      CHECK(step.count() == 3);
                                      seen.z.push_back(step.z());
                                      seen.x0.push_back(step.estimates());
                                  }})
                          .z;
        return seen;
    }

    bool equal(latents<float> const& a, latents<float> const& b) {
        return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
    }

    } // namespace

    TEST_CASE("latents and estimates of the last step are the frames") {
        for (auto const sampler : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            render_settings<float> settings;
            settings.sampler = sampler;
            auto const seen = look(layered{}, settings);
            REQUIRE(seen.z.size() == 3);
            CHECK(equal(seen.z[2], seen.frames));
            CHECK(equal(seen.x0[2], seen.frames));
        }
    }
    TEST_CASE("z of a step of Euler's lies between z before and the estimates, by the noise levels") {
        auto const seen = look(layered{}, {});
        auto const sigmas = karras_schedule<float>(3, 0.0292F, 14.6146F, 7.0F);
        auto const kept = sigmas[2] / sigmas[1];
        for (std::size_t e = 0; e < seen.frames.size(); ++e) {
            auto const expected = kept * seen.z[0].data()[e] + (1 - kept) * seen.x0[1].data()[e];
            CHECK(seen.z[1].data()[e] == doctest::Approx(expected).epsilon(1e-5));
        }
    }
    TEST_CASE("lent latents are downloaded when they are read, and show what the host sees") {
        render_settings<float> settings = render_settings<float>::plain();
        settings.normalization.enabled = false;
        testing::device_denoiser<layered> const device;
        auto const seen = look(device, settings);
        CHECK(device.counts->downloads == 1 + 2 * 3);
        auto const on_host = look(layered{}, settings);
        for (std::size_t step = 0; step < 3; ++step) {
            CHECK(equal(seen.z[step], on_host.z[step]));
            CHECK(equal(seen.x0[step], on_host.x0[step]));
        }
    }
    TEST_CASE("what after_step throws ends the run") {
        auto const maps = testing::random_scene(33, 3, {16, 16}, 2);
        render_settings<float> settings;
        settings.steps = 3;
        settings.keyframes.count = 2;
        std::size_t told = 0;
        CHECK_THROWS_WITH_AS(render(layered{}, to_uv_view(maps),
                                    {.settings = settings,
                                     .after_step =
                                         [&](auto const&) {
                                             ++told;
                                             throw file_error("no room");
                                         }}),
                             "no room", file_error);
        CHECK(told == 1);
    }
}
