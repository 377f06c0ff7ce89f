// SPDX-License-Identifier: MIT
// [GR alg. 1: the loop] Runs whose latents are lent by the denoiser beside runs in host memory.
#include <genrender/pipeline/run_sampler.hpp>

#include "../baselines/layered_denoiser.hpp"
#include "../support/device_denoiser.hpp"
#include "../support/random_scene.hpp"

#include <genrender/baselines/per_frame.hpp>
#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/pipeline/render.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

using namespace genrender;

TEST_SUITE("pipeline/run_sampler") {
    namespace {

    using host = testing::layered_denoiser<float>;
    using device = testing::device_denoiser<host>;
    using whole_device = testing::normalizing_device<host>;

    static_assert(!latent_lender<host> && latent_lender<device> && normalizing_lender<whole_device>);
    static_assert(!normalizing_lender<device>);

    uv_maps const& scene() {
        static auto const maps = testing::random_scene(33, 6, {32, 32}, 3);
        return maps;
    }

    render_settings<float> few_steps() {
        render_settings<float> settings = render_settings<float>::plain();
        settings.steps = 3;
        settings.keyframes.count = 3;
        settings.frames_per_call = 4;
        return settings;
    }

    template <class Method = generative_rendering, class Phi>
    latents<float> frames_of(Phi const& phi, render_settings<float> const& settings, std::size_t threads = 1) {
        return render<Method>(phi, to_uv_view(scene()), {.settings = settings, .loop = threaded_loop(threads)}).z;
    }

    bool are_same(latents<float> const& a, latents<float> const& b) {
        return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
    }

    /// The frames of both devices are those of the host, to the bit.
    void check_devices(render_settings<float> const& settings, std::size_t threads = 1) {
        auto const expected = frames_of(host{}, settings);
        CHECK(are_same(frames_of(device{}, settings, threads), expected));
        CHECK(are_same(frames_of(whole_device{}, settings, threads), expected));
    }

    /// Estimates of frame 4 are not finite.
    struct breaks_at_frame_4 : host {
        template <class Processor>
        void operator()(strided_view<float, 4> x0, strided_view<float const, 4> z, float sigma,
                        std::span<frame_index const> frames, Processor& processor) const {
            host::operator()(x0, z, sigma, frames, processor);
            for (std::size_t i = 0; i < frames.size(); ++i) {
                if (frames[i].value == 4) {
                    x0(i, 1, 2, 3) = std::numeric_limits<float>::quiet_NaN();
                }
            }
        }
    };

    } // namespace

    TEST_CASE("latents on a device give the frames of the host to the bit with every sampler and normalisation") {
        for (auto const sampler : {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m}) {
            auto settings = few_steps();
            settings.sampler = sampler;
            settings.normalization.enabled = false;
            check_devices(settings);
            settings.normalization.enabled = true;
            check_devices(settings);
        }
    }
    TEST_CASE("so do deviations, noisy latents, frames without background and a window of normalisation") {
        auto settings = few_steps();
        auto& normalization = settings.normalization;
        normalization.statistics = adain_statistics::mean_and_deviation;
        check_devices(settings);
        normalization.on_noisy_latents = true;
        check_devices(settings);
        normalization.window_end = 0.5F;
        check_devices(settings);
        for (auto const fallback : {without_background::all_pixels, without_background::skip}) {
            normalization = {.least_pixels = 45, .fallback = fallback};
            check_devices(settings);
        }
    }
    TEST_CASE("so do one frame a call, a filled last call, threads, and steps without keyframes") {
        auto settings = few_steps();
        settings.frames_per_call = 1;
        check_devices(settings, 2);
        settings.frames_per_call = 4;
        settings.fills_last_call = true;
        check_devices(settings);
        settings.frames_per_call = 8; // more than there are frames
        check_devices(settings);
        settings.fills_last_call = false;
        settings.window_begin = 0.5F;
        check_devices(settings);
    }
    TEST_CASE("so do the baselines") {
        auto const settings = few_steps();
        check_devices(per_frame(settings));
        CHECK(are_same(frames_of<pix2video>(whole_device{}, settings), frames_of<pix2video>(host{}, settings)));
        CHECK(are_same(frames_of<tokenflow>(whole_device{}, settings), frames_of<tokenflow>(host{}, settings)));
    }
    TEST_CASE("latents go up once and down once a run") {
        auto settings = few_steps();
        settings.sampler = sampler_kind::heun;
        auto const evaluations_of_run = evaluations(settings.sampler, settings.steps);
        settings.normalization.enabled = false;
        device const without;
        frames_of(without, settings);
        CHECK(without.counts->uploads == 1);
        CHECK(without.counts->downloads == 1);
        CHECK(without.counts->host_calls == 0);
        CHECK(without.counts->calls == evaluations_of_run * 3); // the keyframes, and calls of 4 and of 2 frames

        // Normalisation takes the background up once where it is lent, and all latents down and up where it is not.
        settings.normalization.enabled = true;
        whole_device const lends;
        frames_of(lends, settings);
        CHECK(lends.counts->uploads == 2);
        CHECK(lends.counts->downloads == 1);
        CHECK(lends.counts->statistics == evaluations_of_run);
        device const does_not;
        frames_of(does_not, settings);
        CHECK(does_not.counts->uploads == 1 + evaluations_of_run);
        CHECK(does_not.counts->downloads == 1 + evaluations_of_run);
    }
    TEST_CASE("a denoiser that stops and lends residuals does so on handles") {
        using stopping = testing::stopping_device<host>;
        static_assert(latent_lender<stopping> && residual_lender<stopping>);
        auto const settings = few_steps();
        stopping const phi;
        CHECK(are_same(frames_of(phi, settings), frames_of(host{}, settings)));
        CHECK(phi.counts->stopped == 3);
        CHECK(phi.counts->reused == 6);
        CHECK(phi.counts->host_calls == 0);
    }
    TEST_CASE("a cancelled run downloads the latents of the last whole step") {
        for (auto const steps_until : {0U, 2U}) {
            auto settings = few_steps();
            settings.sampler = sampler_kind::dpmpp_2m;
            auto const until = [&](progress const& now) { return now.step < steps_until; };
            auto const on_host = render(host{}, to_uv_view(scene()), {.settings = settings, .observer = until});
            whole_device const phi;
            auto const on_device = render(phi, to_uv_view(scene()), {.settings = settings, .observer = until});
            CHECK(on_host.is_cancelled);
            CHECK(on_device.is_cancelled);
            CHECK(are_same(on_device.z, on_host.z));
            CHECK(phi.counts->downloads == 1);
        }
    }
    TEST_CASE("estimates on a device that are not finite end the run with the sentence of the host") {
        testing::device_denoiser<breaks_at_frame_4> const phi;
        CHECK_THROWS_WITH_AS(
            frames_of(phi, few_steps()),
            "sequence_denoiser: the denoiser's estimate of frame 4 in step 0 is nan, expected finite latents",
            value_error);
        CHECK(phi.counts->downloads == 1); // for the sentence alone
    }
    TEST_CASE("reports are those of the host") {
        auto settings = few_steps();
        settings.normalization.least_pixels = 45;
        auto const on_host = render(host{}, to_uv_view(scene()), {.settings = settings}).report;
        auto const on_device = render(whole_device{}, to_uv_view(scene()), {.settings = settings}).report;
        CHECK(!on_host.skipped_frames.empty());
        CHECK(on_device.skipped_frames == on_host.skipped_frames);
        CHECK(on_device.coverage.at({8, 8}).covered == on_host.coverage.at({8, 8}).covered);
        CHECK(on_device.denoiser_seconds > 0);
    }
}
