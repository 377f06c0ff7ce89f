// SPDX-License-Identifier: MIT
// Runs that are left after a step and gone on with, through streams that are whole, damaged or of somebody else.
#include <genrender/pipeline/checkpoint.hpp>

#include "../support/device_denoiser.hpp"
#include "../support/random_scene.hpp"

#include <genrender/baselines/baseline_settings.hpp>
#include <genrender/baselines/per_frame.hpp>
#include <genrender/baselines/pix2video.hpp>
#include <genrender/baselines/tokenflow.hpp>
#include <genrender/pipeline/render.hpp>
#include <genrender/testing/analytic_denoiser.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <vector>

using namespace genrender;

TEST_SUITE("pipeline/checkpoint") {
    namespace {

    template <class Real>
    using known = testing::analytic_denoiser<Real>;
    template <class Real>
    known<Real> attending() {
        return {.grid = {8, 8}, .attention = Real(0.5)};
    }

    uv_maps const& small_world() {
        static auto const maps = testing::random_scene(33, 4, {16, 16}, 3);
        return maps;
    }

    template <class Real>
    render_settings<Real> four_steps(render_settings<Real> settings = {}) {
        settings.steps = 4;
        settings.keyframes.count = 2;
        settings.consensus.sources.count = 2;
        return settings;
    }

    /// Equal to the bit.
    template <class Real>
    bool same_bits(latents<Real> const& a, latents<Real> const& b) {
        return a.shape() == b.shape() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) == 0;
    }

    template <class Real>
    std::string written(checkpoint<Real> const& from) {
        std::ostringstream stream;
        write_checkpoint(stream, from);
        return stream.str();
    }
    template <class Real>
    checkpoint<Real> read_back(std::string const& text) {
        std::istringstream stream(text);
        return read_checkpoint<Real>(stream);
    }

    /// The checkpoints after all steps of a run, as streams.
    template <class Method = generative_rendering, class Phi, class Real = typename Phi::real_type>
    std::vector<std::string> left_behind(Phi const& phi, render_settings<Real> const& settings) {
        std::vector<std::string> all;
        render<Method>(phi, to_uv_view(small_world()),
                       {.settings = settings, .after_step = [&](finished_step<Real> const& step) {
                            CHECK(step.number() == all.size());
                            all.push_back(written(step.make_checkpoint()));
                        }});
        return all;
    }

    /// Whoever goes on from a step of a run ends with its frames and its report.
    template <class Method = generative_rendering, class Phi, class Real = typename Phi::real_type>
    void check_going_on(Phi const& phi, render_settings<Real> const& settings) {
        auto const in_one_go = render<Method>(phi, to_uv_view(small_world()), {.settings = settings});
        auto const all = left_behind<Method>(phi, settings);
        REQUIRE(all.size() == settings.steps);
        for (std::size_t step = 0; step < all.size(); ++step) {
            CAPTURE(step);
            auto const from = read_back<Real>(all[step]);
            CHECK(from.steps == step + 1);
            std::vector<std::string> later;
            auto const result = render<Method>(phi, to_uv_view(small_world()),
                                               {.settings = settings,
                                                .after_step =
                                                    [&](finished_step<Real> const& done) {
                                                        auto here = done.make_checkpoint();
                                                        here.report = {};
                                                        later.push_back(written(here));
                                                    },
                                                .resume = &from});
            CHECK(same_bits(result.z, in_one_go.z));
            CHECK(!result.is_cancelled);
            CHECK(result.report.skipped_frames == in_one_go.report.skipped_frames);
            CHECK(result.report.consensus.covered == in_one_go.report.consensus.covered);
            REQUIRE(result.report.coverage.size() == in_one_go.report.coverage.size());
            for (auto const& [grid, count] : in_one_go.report.coverage) {
                CHECK(result.report.coverage.at(grid).covered == count.covered);
            }
            CHECK(result.report.denoiser_seconds >= from.report.denoiser_seconds);
            // What it leaves behind is what the run in one go left, but for the time in its report.
            REQUIRE(later.size() == settings.steps - from.steps);
            for (std::size_t i = 0; i < later.size(); ++i) {
                auto expected = read_back<Real>(all[from.steps + i]);
                expected.report = {};
                CHECK(later[i] == written(expected));
            }
        }
    }

    constexpr auto every_sampler = {sampler_kind::euler, sampler_kind::heun, sampler_kind::dpmpp_2m};

    /// A checkpoint of 2 frames of 1 x 2 x 2 with all that one may have.
    checkpoint<float> small_one() {
        checkpoint<float> one{2, latents<float>::from_shape({2, 1, 2, 2}), {}, {1, 2, 3}, {}};
        for (std::size_t i = 0; i < one.z.size(); ++i) {
            one.z.data()[i] = static_cast<float>(i) - 0.5F;
        }
        one.z.data()[3] = -0.0F;
        one.x0_last = one.z;
        one.x0_last->data()[0] = 7;
        one.report.coverage[{8, 4}] = {10, 9};
        one.report.skipped_frames = {1};
        one.report.denoiser_seconds = 1.5;
        one.report.kernels = chosen_vector_target();
        return one;
    }

    } // namespace

    TEST_CASE_TEMPLATE("a run that goes on from any step ends with the same bits with every sampler", Real, float,
                       double) {
        for (auto const sampler : every_sampler) {
            auto settings = four_steps<Real>();
            settings.sampler = sampler;
            check_going_on(attending<Real>(), settings);
        }
    }
    TEST_CASE(
        "so it does with normalisation of clean and of noisy latents, without a consensus, and on noise of texels") {
        for (auto const sampler : every_sampler) {
            auto settings = four_steps(render_settings<float>::plain());
            settings.sampler = sampler;
            settings.normalization.least_pixels = 20; // some frames are skipped
            check_going_on(attending<float>(), settings);
            settings.normalization.on_noisy_latents = true;
            check_going_on(attending<float>(), settings);
            check_going_on(attending<float>(), four_steps(render_settings<float>::paper()));
        }
    }
    TEST_CASE("so it does with every method") {
        for (auto const sampler : every_sampler) {
            auto settings = four_steps<float>();
            settings.sampler = sampler;
            check_going_on(attending<float>(), per_frame(settings));
            check_going_on<pix2video>(attending<float>(), baseline_settings(settings));
            check_going_on<tokenflow>(attending<float>(), baseline_settings(settings));
        }
    }
    TEST_CASE("so it does with latents that an engine lends, whose checkpoints are those of the host") {
        testing::device_denoiser<known<float>> device;
        static_cast<known<float>&>(device) = attending<float>();
        for (auto const sampler : every_sampler) {
            auto settings = four_steps<float>(render_settings<float>::plain());
            settings.sampler = sampler;
            check_going_on(device, settings);
            auto const on_device = left_behind(device, settings);
            auto const on_host = left_behind(attending<float>(), settings);
            for (std::size_t step = 0; step < 4; ++step) {
                CHECK(same_bits(read_back<float>(on_device[step]).z, read_back<float>(on_host[step]).z));
            }
        }
    }
    TEST_CASE("a run goes on with another number of frames a call and of threads") {
        auto settings = four_steps<float>();
        auto const in_one_go = render(attending<float>(), to_uv_view(small_world()), {.settings = settings});
        auto const from = read_back<float>(left_behind(attending<float>(), settings)[1]);
        settings.frames_per_call = 3;
        auto const result = render(attending<float>(), to_uv_view(small_world()),
                                   {.settings = settings, .loop = threaded_loop(2), .resume = &from});
        CHECK(same_bits(result.z, in_one_go.z));
    }
    TEST_CASE("a run that its observer ends in a step goes on from the step before") {
        auto settings = four_steps<double>();
        settings.sampler = sampler_kind::dpmpp_2m;
        auto const in_one_go = render(attending<double>(), to_uv_view(small_world()), {.settings = settings});
        checkpoint<double> last;
        auto const ended = render(attending<double>(), to_uv_view(small_world()),
                                  {.settings = settings,
                                   .observer = [](progress const& now) { return now.step < 2; },
                                   .after_step = [&](auto const& step) { last = step.make_checkpoint(); }});
        CHECK(ended.is_cancelled);
        CHECK(last.steps == 2);
        CHECK(same_bits(last.z, ended.z));
        CHECK(
            same_bits(render(attending<double>(), to_uv_view(small_world()), {.settings = settings, .resume = &last}).z,
                      in_one_go.z));
    }
    TEST_CASE("progress of a run that goes on counts what is left to do") {
        for (auto const sampler : every_sampler) {
            auto settings = four_steps<float>();
            settings.sampler = sampler;
            for (std::size_t const steps : {1U, 3U, 4U}) {
                auto const from = read_back<float>(left_behind(attending<float>(), settings)[steps - 1]);
                std::size_t denoised = 0;
                double remaining = 0;
                auto const count = [&](progress const& now) {
                    CHECK(now.step >= steps);
                    denoised += now.frames_done == now.frames ? now.frames : 0;
                    remaining = now.remaining_seconds;
                    return true;
                };
                render(attending<float>(), to_uv_view(small_world()),
                       {.settings = settings, .observer = count, .resume = &from});
                CHECK(denoised == frames_to_denoise(settings, 4, generative_rendering{}, steps));
                CHECK(remaining == 0);
            }
        }
    }
    TEST_CASE(
        "a run that nobody asks for a checkpoint takes no fingerprint, and frames do not depend on who looks on") {
        auto settings = four_steps<float>();
        std::size_t asked = 0;
        settings.alpha = [&](std::size_t, attention_site const&) {
            ++asked;
            return 0.7F;
        };
        auto const z = render(attending<float>(), to_uv_view(small_world()), {.settings = settings}).z;
        auto const without = asked;
        auto const looked_at =
            render(attending<float>(), to_uv_view(small_world()),
                   {.settings = settings, .after_step = [](auto const& step) { CHECK(step.count() == 4); }});
        CHECK(asked == 2 * without);
        CHECK(same_bits(looked_at.z, z));
        left_behind(attending<float>(), settings);
        CHECK(asked > 3 * without);
    }

    TEST_CASE("what is written is read to the bit, and what follows stays in the stream") {
        auto const one = small_one();
        std::istringstream stream(written(one) + "and more");
        auto const back = read_checkpoint<float>(stream);
        CHECK(written(back) == written(one));
        CHECK(same_bits(back.z, one.z));
        CHECK(same_bits(*back.x0_last, *one.x0_last));
        CHECK(back.run == one.run);
        CHECK(back.report.coverage.at({8, 4}).covered == 9);
        CHECK(back.report.skipped_frames == one.report.skipped_frames);
        CHECK(back.report.denoiser_seconds == 1.5);
        std::string rest;
        std::getline(stream, rest);
        CHECK(rest == "and more");
    }
    TEST_CASE("a stream in which any bit is changed is refused") {
        auto const whole = written(small_one());
        std::size_t refused = 0;
        for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
            auto damaged = whole;
            damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
            try {
                read_back<float>(damaged);
                CAPTURE(bit);
                CHECK(false);
            } catch (file_error const& error) {
                refused += std::string(error.what()).starts_with("checkpoint: ") ? std::size_t{1} : std::size_t{0};
            }
        }
        CHECK(refused == 8 * whole.size());
    }
    TEST_CASE("a stream that ends anywhere before its end is refused") {
        auto const whole = written(small_one());
        for (std::size_t length = 0; length < whole.size(); ++length) {
            CAPTURE(length);
            CHECK_THROWS_AS(read_back<float>(whole.substr(0, length)), file_error);
        }
        CHECK_THROWS_WITH(read_back<float>(whole.substr(0, 100)), "checkpoint: ends after 100 bytes, expected more");
    }
    TEST_CASE("foreign streams, numbers of another width and impossible sizes are refused by what they are") {
        CHECK_THROWS_WITH(read_back<float>("This is a letter and not a checkpoint."),
                          "checkpoint: begins with other bytes than one that this version writes, expected a "
                          "checkpoint of genrender");
        CHECK_THROWS_WITH(read_back<double>(written(small_one())),
                          "checkpoint: its numbers are of 4 bytes, expected 8");
        // The extents stand after what the stream is, the width of its numbers and the steps.
        auto const with_extent = [](std::size_t axis, std::uint64_t extent) {
            auto text = written(small_one());
            for (std::size_t byte = 0; byte < 8; ++byte) {
                text[32 + 8 * axis + byte] = static_cast<char>(static_cast<unsigned char>(extent >> (8 * byte)));
            }
            return text;
        };
        CHECK(written(read_back<float>(with_extent(0, 2))) == written(small_one()));
        CHECK_THROWS_WITH(read_back<float>(with_extent(0, 0)),
                          "checkpoint: extent of latents is 0, expected 1 or more");
        CHECK_THROWS_WITH(read_back<float>(with_extent(1, std::numeric_limits<std::uint64_t>::max())),
                          "checkpoint: extent of latents is 18446744073709551615, expected at most 549755813888");
        // 2^40 numbers, of which memory is taken for what the stream has.
        CHECK_THROWS_WITH(read_back<float>(with_extent(1, std::uint64_t{1} << 37)), doctest::Contains("expected more"));
    }
    TEST_CASE("a stream that takes no more is a sentence") {
        std::ostringstream full;
        full.setstate(std::ios::badbit);
        CHECK_THROWS_WITH_AS(write_checkpoint(full, small_one()),
                             "checkpoint: not all of it could be written, expected room for it", file_error);
    }

    TEST_CASE("a checkpoint of another run is refused before anything is run, by what differs") {
        auto const settings = four_steps<float>();
        auto const from = read_back<float>(left_behind(attending<float>(), settings)[0]);
        auto const refusal = [&](auto const& phi, uv_maps const& maps, render_settings<float> const& told,
                                 std::string const& key = "") {
            try {
                render(phi, to_uv_view(maps),
                       {.settings = told,
                        .observer =
                            [](progress const&) {
                                FAIL("it ran");
                                return true;
                            },
                        .resume = &from,
                        .model_key = key});
            } catch (value_error const& error) {
                return std::string(error.what());
            }
            return std::string("none");
        };
        auto const sentence = [](std::string const& others) {
            return "render: resume is a checkpoint of a run that differs in " + others +
                   ", expected one with the same settings, maps and model";
        };
        auto other = settings;
        other.noise.seed = 1;
        auto const other_maps = testing::random_scene(34, 4, {16, 16}, 3);
        auto const phi = attending<float>();
        CHECK(refusal(phi, small_world(), other) == sentence("settings"));
        CHECK(refusal(phi, other_maps, settings) == sentence("maps"));
        CHECK(refusal(phi, small_world(), settings, "another prompt") == sentence("model"));
        CHECK(refusal(phi, other_maps, other, "another prompt") == sentence("settings and maps and model"));
        auto more_channels = phi;
        more_channels.channels = 4;
        CHECK(refusal(more_channels, small_world(), settings) == sentence("model"));
        CHECK_THROWS_WITH(render<tokenflow>(phi, to_uv_view(small_world()), {.settings = settings, .resume = &from}),
                          sentence("settings").c_str());
    }
    TEST_CASE("a checkpoint that was put together wrongly is refused by what is wrong") {
        auto settings = four_steps<float>();
        settings.sampler = sampler_kind::dpmpp_2m;
        auto const right = read_back<float>(left_behind(attending<float>(), settings)[1]);
        auto const go_on = [&](checkpoint<float> const& from) {
            render(attending<float>(), to_uv_view(small_world()), {.settings = settings, .resume = &from});
        };
        CHECK_NOTHROW(go_on(right));
        auto from = right;
        from.steps = 5;
        CHECK_THROWS_WITH_AS(go_on(from), "render: resume.steps is 5, expected at most settings.steps", value_error);
        from = right;
        from.x0_last.reset();
        CHECK_THROWS_WITH_AS(
            go_on(from),
            "render: resume.x0_last is empty, expected the last clean estimate, which the sampler remembers",
            value_error);
        from = right;
        from.z = latents<float>::from_shape({4, 3, 8, 9});
        CHECK_THROWS_WITH_AS(go_on(from), "render: resume.z is [4, 3, 8, 9], expected [4, 3, 8, 8]", shape_error);
        from = right;
        from.x0_last = latents<float>::from_shape({3, 3, 8, 8});
        CHECK_THROWS_WITH_AS(go_on(from), "render: resume.x0_last is [3, 3, 8, 8], expected [4, 3, 8, 8]", shape_error);
        from = right;
        from.report.kernels = right.report.kernels == vector_target::v4 ? vector_target::v3 : vector_target::v4;
        CHECK_THROWS_WITH_AS(go_on(from), doctest::Contains("the vector target of this run (force_vector_target)"),
                             value_error);
    }
}
